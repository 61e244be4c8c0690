#include "lab/detect/pillar_network.hpp"

#include <fmt/format.h>
#include <torch/autograd.h>
#include <torch/nn/functional/activation.h>
#include <torch/nn/modules/activation.h>
#include <torch/nn/modules/pixelshuffle.h>
#include <torch/types.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/crc32.hpp"
#include "io/file.hpp"
#include "lab/detect/anchors.hpp"

namespace sweepcast::lab {

namespace {

namespace nn = torch::nn;

constexpr std::int64_t kPillarChannels = 64;
constexpr std::int64_t kUpChannels = 32;
constexpr int kHeadChannels = kAnchorsOfCell * (1 + kResiduals + 2);

// A block of the backbone: `layers` convolutions, the first of which halves the resolution.
struct Block {
  std::int64_t layers;
  std::int64_t channels;
  std::int64_t enlarge;  ///< to the first block's resolution
};
constexpr std::array<Block, 3> kBlocks{{{2, 32, 1}, {3, 64, 2}, {2, 64, 4}}};

// The greatest of each pillar's points, channel by channel, and at least 0: the paper's ReLU and
// maximum in one, without padding pillars to the same number of points.
class PillarMaximum : public torch::autograd::Function<PillarMaximum> {
 public:
  static torch::Tensor forward(torch::autograd::AutogradContext* context,
                               const torch::Tensor& points, const torch::Tensor& owner,
                               std::int64_t pillars) {
    const std::int64_t channels = points.size(1);
    const torch::Tensor given = points.contiguous();
    torch::Tensor greatest = torch::zeros({pillars, channels}, given.options());
    torch::Tensor from = torch::full({pillars, channels}, -1, torch::kInt64);
    const float* in = given.data_ptr<float>();
    const std::int64_t* pillar = owner.data_ptr<std::int64_t>();
    float* out = greatest.data_ptr<float>();
    std::int64_t* source = from.data_ptr<std::int64_t>();
    for (std::int64_t i = 0; i < points.size(0); ++i) {
      const std::int64_t row = pillar[i] * channels;
      for (std::int64_t c = 0; c < channels; ++c) {
        if (in[i * channels + c] <= out[row + c]) continue;
        out[row + c] = in[i * channels + c];
        source[row + c] = i;
      }
    }
    context->save_for_backward({from});
    context->saved_data["points"] = points.size(0);
    return greatest;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 const torch::autograd::variable_list& gradients) {
    const torch::Tensor from = context->get_saved_variables()[0];
    const torch::Tensor given = gradients[0].contiguous();
    const std::int64_t channels = from.size(1);
    const std::int64_t points = context->saved_data["points"].toInt();
    torch::Tensor gradient = torch::zeros({points, channels}, given.options());
    const float* in = given.data_ptr<float>();
    const std::int64_t* source = from.data_ptr<std::int64_t>();
    float* out = gradient.data_ptr<float>();
    for (std::int64_t i = 0; i < from.numel(); ++i) {
      if (source[i] >= 0) out[source[i] * channels + i % channels] = in[i];
    }
    return {gradient, torch::Tensor(), torch::Tensor()};
  }
};

nn::BatchNorm2d norm_of(std::int64_t channels) {
  return nn::BatchNorm2d(nn::BatchNorm2dOptions(channels).eps(1e-3).momentum(0.03));
}

nn::Sequential make_block(const Block& block, std::int64_t channels) {
  nn::Sequential layers;
  for (std::int64_t i = 0; i < block.layers; ++i) {
    layers->push_back(
        nn::Conv2d(nn::Conv2dOptions(i == 0 ? channels : block.channels, block.channels, 3)
                       .stride(i == 0 ? 2 : 1)
                       .padding(1)
                       .bias(false)));
    layers->push_back(norm_of(block.channels));
    layers->push_back(nn::ReLU(nn::ReLUOptions().inplace(true)));
  }
  return layers;
}

// A convolution of single places. Dilation does nothing to those, but makes libtorch take oneDNN
// for them on one thread too, where it would otherwise take a BLAS that may be slow.
nn::Conv2dOptions single_places(std::int64_t from, std::int64_t to) {
  return nn::Conv2dOptions(from, to, 1).dilation(2);
}

// A transposed convolution whose stride is its size, as a convolution and a shuffle of its channels
// to places, which libtorch has faster.
nn::Sequential make_up(const Block& block) {
  const std::int64_t places = block.enlarge * block.enlarge;
  return nn::Sequential(nn::Conv2d(single_places(block.channels, kUpChannels * places).bias(false)),
                        nn::PixelShuffle(nn::PixelShuffleOptions(block.enlarge)),
                        norm_of(kUpChannels), nn::ReLU(nn::ReLUOptions().inplace(true)));
}

torch::Tensor tensor_of(std::vector<std::int64_t> numbers) {
  return torch::tensor(numbers, torch::kInt64);
}

// Everything that training changes: weights, and the norms' means and variances.
std::vector<torch::Tensor> tensors_of(PillarNetwork& network) {
  std::vector<torch::Tensor> all = network->parameters();
  for (const torch::Tensor& buffer : network->buffers()) {
    if (buffer.scalar_type() == torch::kFloat32) all.push_back(buffer);
  }
  return all;
}

// The head of a weights' file.
struct WeightsHead {
  std::array<char, 8> magic{'S', 'W', 'P', 'I', 'L', 'L', 'A', 'R'};
  std::uint32_t version = 2;
  std::uint32_t crc32 = 0;  ///< of the numbers
  std::uint64_t count = 0;  ///< of the numbers
};
static_assert(sizeof(WeightsHead) == 24 && std::endian::native == std::endian::little);

}  // namespace

PillarBatch make_batch(std::span<const Pillars> sweeps) {
  constexpr std::int64_t kCells = std::int64_t{PillarGrid::kSide} * PillarGrid::kSide;
  std::vector<float> features;
  std::vector<std::int64_t> owner, cell;
  for (std::size_t b = 0; b < sweeps.size(); ++b) {
    const auto first = static_cast<std::int64_t>(cell.size());
    features.insert(features.end(), sweeps[b].features.begin(), sweeps[b].features.end());
    for (const std::int64_t pillar : sweeps[b].owner) owner.push_back(first + pillar);
    for (const std::int64_t c : sweeps[b].cell) {
      cell.push_back(static_cast<std::int64_t>(b) * kCells + c);
    }
  }
  return {torch::tensor(features).view({static_cast<std::int64_t>(owner.size()), kPointFeatures}),
          tensor_of(std::move(owner)), tensor_of(std::move(cell)),
          static_cast<std::int64_t>(sweeps.size())};
}

PillarNetworkImpl::PillarNetworkImpl()
    : point_layer_(single_places(kPointFeatures, kPillarChannels).bias(false)),
      point_norm_(norm_of(kPillarChannels)),
      head_(single_places(kUpChannels * kBlocks.size(), kHeadChannels)) {
  register_module("point_layer", point_layer_);
  register_module("point_norm", point_norm_);
  std::int64_t channels = kPillarChannels;
  for (std::size_t i = 0; i < kBlocks.size(); ++i) {
    down_.push_back(register_module(fmt::format("down{}", i), make_block(kBlocks[i], channels)));
    up_.push_back(register_module(fmt::format("up{}", i), make_up(kBlocks[i])));
    channels = kBlocks[i].channels;
  }
  register_module("head", head_);
  // Nearly all anchors are on nothing: begin with scores of 0.01 (Lin et al., ICCV 2017).
  const torch::NoGradGuard frozen;
  head_->bias.slice(0, 0, kAnchorsOfCell).fill_(-4.6);
}

PillarOutput PillarNetworkImpl::forward(const PillarBatch& batch) {
  constexpr std::int64_t kSide = PillarGrid::kSide;
  // Points as the pixels of an image one wide, so that the layer is a 1 x 1 convolution.
  torch::Tensor points = batch.features.t().view({1, kPointFeatures, -1, 1});
  points = point_norm_(point_layer_(points)).permute({0, 2, 3, 1}).reshape({-1, kPillarChannels});
  const torch::Tensor pillars = PillarMaximum::apply(points, batch.owner, batch.cell.size(0));
  torch::Tensor image =
      torch::zeros({batch.sweeps * kSide * kSide, kPillarChannels}, pillars.options());
  image = image.index_copy(0, batch.cell, pillars)
              .view({batch.sweeps, kSide, kSide, kPillarChannels})
              .permute({0, 3, 1, 2});
  std::vector<torch::Tensor> scales;
  for (std::size_t i = 0; i < down_.size(); ++i) {
    image = down_[i]->forward(image);
    scales.push_back(up_[i]->forward(image));
  }
  const torch::Tensor said = head_(torch::cat(scales, 1)).permute({0, 2, 3, 1});
  const auto part = [&](std::int64_t begin, std::int64_t end, std::int64_t each) {
    return said.slice(3, begin, end).reshape({batch.sweeps, kAnchors, each});
  };
  constexpr std::int64_t kEndOfResiduals = std::int64_t{kAnchorsOfCell} * (1 + kResiduals);
  return {part(0, kAnchorsOfCell, 1).squeeze(2), part(kAnchorsOfCell, kEndOfResiduals, kResiduals),
          part(kEndOfResiduals, kHeadChannels, 2)};
}

Status write_weights(const std::filesystem::path& file, PillarNetwork& network) {
  std::vector<torch::Tensor> flat;
  for (const torch::Tensor& tensor : tensors_of(network)) flat.push_back(tensor.detach().flatten());
  const torch::Tensor all = torch::cat(flat).contiguous();
  const auto numbers =
      std::as_bytes(std::span(all.data_ptr<float>(), static_cast<std::size_t>(all.numel())));
  WeightsHead head;
  head.crc32 = crc32(numbers);
  head.count = static_cast<std::uint64_t>(all.numel());
  auto made = NewFile::create(file);
  if (!made) return tl::unexpected(made.error());
  if (Status status = made->write(std::as_bytes(std::span(&head, 1))); !status) return status;
  if (Status status = made->write(numbers); !status) return status;
  return made->commit(false);
}

Status read_weights(const std::filesystem::path& file, PillarNetwork& network) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 24U;
  std::vector<std::byte> bytes;
  if (Status read = read_file(file, kMostBytes, bytes); !read) return read;
  const std::string name = file.string();
  WeightsHead head;
  const WeightsHead wanted;
  if (bytes.size() >= sizeof(head)) std::memcpy(&head, bytes.data(), sizeof(head));
  if (bytes.size() < sizeof(head) || head.magic != wanted.magic) {
    return fail(ErrorCode::corrupt,
                name + ": holds no weights; give a file that `sweepcast train-detector` wrote");
  }
  std::vector<torch::Tensor> tensors = tensors_of(network);
  std::uint64_t count = 0;
  for (const torch::Tensor& tensor : tensors) count += static_cast<std::uint64_t>(tensor.numel());
  if (head.version != wanted.version || head.count != count) {
    return fail(ErrorCode::unsupported,
                name +
                    ": holds the weights of another network; train them again with `sweepcast "
                    "train-detector`");
  }
  const std::span<const std::byte> numbers = std::span(bytes).subspan(sizeof(head));
  if (numbers.size() != count * sizeof(float)) {
    return fail(ErrorCode::truncated, name + ": is cut short; copy it again");
  }
  if (crc32(numbers) != head.crc32) {
    return fail(ErrorCode::corrupt, name + ": its checksum is wrong; copy it again");
  }
  const torch::NoGradGuard frozen;
  std::size_t offset = 0;
  for (torch::Tensor& tensor : tensors) {
    torch::Tensor filed = torch::empty_like(tensor, torch::MemoryFormat::Contiguous);
    const std::size_t size = static_cast<std::size_t>(tensor.numel()) * sizeof(float);
    std::memcpy(filed.data_ptr<float>(), numbers.data() + offset, size);
    tensor.copy_(filed);
    offset += size;
  }
  return {};
}

}  // namespace sweepcast::lab
