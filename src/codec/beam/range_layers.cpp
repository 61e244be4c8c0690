#include "codec/beam/range_layers.hpp"

#include <algorithm>
#include <variant>

#include "codec/beam/step_coder.hpp"

namespace sweepcast::beam {
namespace {

using FastCoder = StepCoder<1, 1>;
using NormalCoder = StepCoder<3, 2>;
using FormerBestCoder = StepCoder<4, 5>;
using BestCoder = StepCoder<kDeep, 9>;

// The weight of the upper of two rows for a row between, 1/256: a plane's inverse range is about
// linear in the tangent of elevation.
std::int32_t row_weight(const std::vector<std::int32_t>& elevation, int row, int stride) {
  constexpr std::int32_t kEven = 128;
  if (row + stride >= static_cast<int>(elevation.size())) return kEven;
  const auto at = [&](int r) { return std::int64_t{elevation[static_cast<std::size_t>(r)]}; };
  const std::int64_t whole = at(row - stride) - at(row + stride);
  const std::int64_t part = at(row) - at(row + stride);
  if (part <= 0 || part >= whole) return kEven;
  return static_cast<std::int32_t>(part * 256 / whole);
}

// A run that begins at `cell` of `plane`, its neighbours not yet said.
Run run_at(Plane& plane, std::ptrdiff_t cell) {
  Run run;
  run.states.cell = plane.state.data() + cell;
  run.range = plane.range.data() + cell;
  run.activity = plane.activity.data() + cell;
  return run;
}

// Says that the neighbours of one place are at `at` of `plane`; `state` is the place's in the run.
void place_neighbour(const Plane& plane, std::ptrdiff_t at, Neighbours::Place which, Run& run,
                     const CellState*& state) {
  run.neighbours.range[which] = plane.range.data() + at;
  if (which < Neighbours::kActive) run.neighbours.activity[which] = plane.activity.data() + at;
  state = plane.state.data() + at;
}

// A run of cells at `cell` of `plane`, with neighbours at these distances in the plane: `along` to
// the known ones on the axis that is halved, `across` on the other.
Run run_within(Plane& plane, std::ptrdiff_t cell, std::ptrdiff_t along, std::ptrdiff_t across) {
  using N = Neighbours;
  Run run = run_at(plane, cell);
  const auto place = [&](N::Place which, std::ptrdiff_t at, const CellState*& state) {
    place_neighbour(plane, at, which, run, state);
  };
  RunStates& s = run.states;
  place(N::a, cell - along, s.a);
  place(N::b, cell + along, s.b);
  place(N::n, cell - across, s.n);
  place(N::na, cell - across - along, s.na);
  place(N::nb, cell - across + along, s.nb);
  place(N::sa, cell + across - along, s.sa);
  place(N::sb, cell + across + along, s.sb);
  place(N::aa, cell - 2 * along, s.aa);
  place(N::bb, cell + 2 * along, s.bb);
  place(N::nn, cell - 2 * across, s.nn);
  run.neighbours.range[N::near] = run.neighbours.range[N::nn];
  run.sequential = true;
  return run;
}

// The last range known before each cell of a row, or the first after it.
void find_near(const Plane& plane, int row, std::vector<std::int32_t>& near) {
  const std::int32_t* range = plane.range.data() + plane.at(row, 0);
  const auto count = static_cast<std::size_t>(plane.cols());
  near.assign(range, range + count);
  std::int32_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    last = near[i] > 0 ? near[i] : last;
    near[i] = last;
  }
  const auto first = std::find_if(near.begin(), near.end(), [](std::int32_t r) { return r > 0; });
  if (first != near.end()) std::fill(near.begin(), first, *first);
}

// A row of the plane `odd`, whose columns lie between those of `even`.
Run run_between(const Plane& even, Plane& odd, int row, std::vector<std::int32_t>& near) {
  using N = Neighbours;
  const std::ptrdiff_t known = even.at(row, 0);
  const std::ptrdiff_t fresh = odd.at(row, 0);
  Run run = run_at(odd, fresh);
  const auto place = [&](N::Place which, const Plane& plane, std::ptrdiff_t at,
                         const CellState*& state) {
    place_neighbour(plane, at, which, run, state);
  };
  RunStates& s = run.states;
  place(N::a, even, known, s.a);
  place(N::b, even, known + 1, s.b);
  place(N::n, odd, fresh - odd.pitch(), s.n);
  place(N::na, even, known - even.pitch(), s.na);
  place(N::nb, even, known - even.pitch() + 1, s.nb);
  place(N::sa, even, known + even.pitch(), s.sa);
  place(N::sb, even, known + even.pitch() + 1, s.sb);
  place(N::aa, even, known - 1, s.aa);
  place(N::bb, even, known + 2, s.bb);
  place(N::nn, odd, fresh - 2 * odd.pitch(), s.nn);
  find_near(even, row, near);
  run.neighbours.range[N::near] = near.data();
  return run;
}

// Angular residuals: mostly zero, and where not, much like the one before.
class AngleCoder {
 public:
  void begin() {
    mixer_.reset();
    last_ = 0;
    last_negative_ = 0;
  }

  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t value) {
    const auto size = static_cast<std::uint32_t>(std::abs(value));
    const std::uint32_t near = std::min(last_, 31U);
    std::uint32_t coded = 0;
    while (coded < kUnary &&
           mixer_.code(coder, {hash_context(coded, near), hash_context(coded, 100U)}, 0,
                       size > coded)) {
      ++coded;
    }
    if (coded == kUnary) {
      std::uint32_t rest = 0;
      for (int bit = kPlainBits; bit-- > 0;) {
        rest = rest * 2 + (coder.code((((size - kUnary) >> bit) & 1U) != 0, kEven) ? 1U : 0U);
      }
      coded += rest;
    }
    last_ = (last_ + coded + 1) / 2;
    if (coded == 0) return 0;
    const bool negative = mixer_.code(
        coder, {hash_context(200U, last_negative_), hash_context(201U, near)}, 1, value < 0);
    last_negative_ = negative ? 1U : 0U;
    return negative ? -static_cast<std::int32_t>(coded) : static_cast<std::int32_t>(coded);
  }

 private:
  static constexpr std::uint32_t kUnary = 20;
  static constexpr std::uint32_t kEven = 32'768;
  static constexpr int kPlainBits = 24;
  BitMixer<2> mixer_{12, 2};
  std::uint32_t last_ = 0;
  std::uint32_t last_negative_ = 0;
};

}  // namespace

struct LayerCoder::State {
  LayerPlan plan;
  Plane known;  ///< every `stride`-th column of the image
  Plane fresh;  ///< the columns between, while they are coded
  Plane merged;
  int stride = 1;
  std::variant<std::unique_ptr<FastCoder>, std::unique_ptr<NormalCoder>,
               std::unique_ptr<FormerBestCoder>, std::unique_ptr<BestCoder>>
      coder;
  AngleCoder azimuth, height;
  std::vector<std::int32_t> truth;  ///< of a run
  std::vector<std::int32_t> near;   ///< of a run

  [[nodiscard]] bool has_fresh() const { return stride < plan.lattice.front().col_stride; }
  template <class Coder, class Steps>
  void code_step(Coder& coder_of_bits, Steps& steps, std::uint32_t number, LayerQuality quality,
                 const std::int32_t* range);
  template <class Visit>
  void for_each_point(std::uint32_t number, Visit visit) const;
};

// Codes the cells that a step adds, row by row. `range` is null when decoding.
template <class Coder, class Steps>
void LayerCoder::State::code_step(Coder& coder_of_bits, Steps& steps, std::uint32_t number,
                                  LayerQuality quality, const std::int32_t* range) {
  const LatticeStep& step = plan.lattice[number];
  const Traversal at(step);
  const bool columns = step.kind == LatticeStep::Kind::columns;
  const auto count =
      static_cast<std::size_t>((plan.cols - at.first_col + at.col_stride - 1) / at.col_stride);
  if (columns) {
    if (number > 1 && plan.lattice[number - 1].kind == LatticeStep::Kind::columns) {
      interleave(known, fresh, merged);
      std::swap(known, merged);
    }
    stride = step.col_stride;
    fresh.reset(plan.rows, static_cast<int>(count), 2);
  }
  steps.begin_step(quality.step, quality.tolerance, plan.stages);
  truth.resize(count);
  for (int row = at.first_row; row < plan.rows; row += at.row_stride) {
    const std::ptrdiff_t down = step.row_stride * known.pitch();
    const std::ptrdiff_t cell = known.at(row, 0);
    Run run = columns                                ? run_between(known, fresh, row, near)
              : step.kind == LatticeStep::Kind::rows ? run_within(known, cell, down, 1)
                                                     : run_within(known, cell, 1, down);
    run.states.count = count;
    run.states.step = number;
    run.states.row = static_cast<std::uint32_t>(row);
    if (step.kind == LatticeStep::Kind::rows) {
      run.neighbours.weight = row_weight(plan.elevation, row, step.row_stride);
    }
    if (range != nullptr) {
      const std::int32_t* from =
          range + static_cast<std::ptrdiff_t>(row) * plan.cols + at.first_col;
      for (std::size_t i = 0; i < count; ++i) {
        truth[i] = from[static_cast<std::ptrdiff_t>(i) * at.col_stride];
      }
    }
    if (ran_dry(coder_of_bits)) return;
    steps.code(coder_of_bits, run, range == nullptr ? nullptr : truth.data());
  }
}

// Calls visit(index of the cell) for the cells of a step that hold a measured point.
template <class Visit>
void LayerCoder::State::for_each_point(std::uint32_t number, Visit visit) const {
  const Traversal at(plan.lattice[number]);
  const Plane& plane = plan.lattice[number].kind == LatticeStep::Kind::columns ? fresh : known;
  for (int row = at.first_row; row < plan.rows; row += at.row_stride) {
    std::ptrdiff_t cell = plane.at(row, 0);
    for (int col = at.first_col; col < plan.cols; col += at.col_stride, ++cell) {
      if (plane.state[static_cast<std::size_t>(cell)] != CellState::measured) continue;
      visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(plan.cols) +
            static_cast<std::size_t>(col));
    }
  }
}

LayerCoder::LayerCoder() : state_(std::make_unique<State>()) {}
LayerCoder::LayerCoder(LayerCoder&&) noexcept = default;
LayerCoder& LayerCoder::operator=(LayerCoder&&) noexcept = default;
LayerCoder::~LayerCoder() = default;

void LayerCoder::begin(const LayerPlan& plan) {
  State& s = *state_;
  s.plan = plan;
  const LatticeStep& base = plan.lattice.front();
  s.stride = base.col_stride;
  s.known.reset(plan.rows, (plan.cols + base.col_stride - 1) / base.col_stride,
                2 * base.row_stride);
  const auto use = [&]<class Steps>(std::in_place_type_t<Steps> /*type*/) {
    if (!std::holds_alternative<std::unique_ptr<Steps>>(s.coder) ||
        std::get<std::unique_ptr<Steps>>(s.coder) == nullptr) {
      s.coder = std::make_unique<Steps>();
    }
  };
  switch (plan.effort) {
    case Effort::fast:
      use(std::in_place_type<FastCoder>);
      break;
    case Effort::normal:
      use(std::in_place_type<NormalCoder>);
      break;
    case Effort::best:
      if (plan.former_best) {
        use(std::in_place_type<FormerBestCoder>);
      } else {
        use(std::in_place_type<BestCoder>);
      }
      break;
  }
  std::visit([](auto& steps) { steps->reset(); }, s.coder);
  s.azimuth.begin();
  s.height.begin();
}

int LayerCoder::layers(const LayerPlan& plan) {
  const std::uint32_t base = steps_of(plan.lattice, 0).second;
  return 1 + static_cast<int>(plan.lattice.size() - base);
}

void LayerCoder::encode(int layer, const LayerValues& values, std::vector<std::byte>& out) {
  State& s = *state_;
  RangeEncoder coder(out);
  const auto [first, last] = steps_of(s.plan.lattice, layer);
  const LayerQuality quality = s.plan.quality[static_cast<std::size_t>(layer)];
  for (std::uint32_t step = first; step < last; ++step) {
    std::visit([&](auto& steps) { s.code_step(coder, *steps, step, quality, values.range.data()); },
               s.coder);
    if (values.azimuth.empty()) continue;
    s.for_each_point(step, [&](std::size_t cell) {
      s.azimuth.code(coder, values.azimuth[cell]);
      s.height.code(coder, values.height[cell]);
    });
  }
  coder.finish();
}

bool LayerCoder::decode(int layer, std::span<const std::byte> bytes,
                        const LayerResiduals& residuals) {
  State& s = *state_;
  RangeDecoder coder(bytes);
  const auto [first, last] = steps_of(s.plan.lattice, layer);
  const LayerQuality quality = s.plan.quality[static_cast<std::size_t>(layer)];
  for (std::uint32_t step = first; step < last; ++step) {
    std::visit([&](auto& steps) { s.code_step(coder, *steps, step, quality, nullptr); }, s.coder);
    if (coder.overran()) return false;
    if (residuals.azimuth.empty()) continue;
    s.for_each_point(step, [&](std::size_t cell) {
      residuals.azimuth[cell] = s.azimuth.code(coder, 0);
      residuals.height[cell] = s.height.code(coder, 0);
    });
  }
  return !coder.overran();
}

std::size_t LayerCoder::measured() const {
  const auto count = [](const Plane& plane) {
    return std::count(plane.state.begin(), plane.state.end(), CellState::measured);
  };
  return static_cast<std::size_t>(count(state_->known) +
                                  (state_->has_fresh() ? count(state_->fresh) : 0));
}

void LayerCoder::read(std::vector<std::int32_t>& range, std::vector<CellState>& state) const {
  const State& s = *state_;
  const auto cols = static_cast<std::size_t>(s.plan.cols);
  range.assign(cols * static_cast<std::size_t>(s.plan.rows), 0);
  state.assign(range.size(), CellState::unknown);
  const auto scatter = [&](const Plane& plane, std::size_t first, std::size_t every) {
    for (int row = 0; row < plane.rows(); ++row) {
      auto from = static_cast<std::size_t>(plane.at(row, 0));
      const std::size_t begin = static_cast<std::size_t>(row) * cols;
      for (std::size_t col = first; col < cols; col += every, ++from) {
        range[begin + col] = plane.range[from];
        state[begin + col] = plane.state[from];
      }
    }
  };
  const bool between = s.has_fresh();
  const auto every = static_cast<std::size_t>(s.stride);
  scatter(s.known, 0, between ? 2 * every : every);
  if (between) scatter(s.fresh, every, 2 * every);
}

}  // namespace sweepcast::beam
