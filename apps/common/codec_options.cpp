#include "common/codec_options.hpp"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "common/validators.hpp"

namespace sweepcast::app {

namespace {

/// Reads exactly N finite numbers separated by commas; throws CLI::ValidationError otherwise.
template <std::size_t N>
std::array<double, N> parse_numbers(const std::string& option, const std::string& text,
                                    std::string_view form) {
  std::array<double, N> numbers{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < N; ++i) {
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    const bool separated = i + 1 < N ? next != end && *next == ',' : next == end;
    if (error != std::errc{} || !separated || !std::isfinite(numbers[i])) {
      throw CLI::ValidationError(
          option, fmt::format("\"{}\" is not {}: {} numbers, separated by commas", text, form, N));
    }
    at = next + (i + 1 < N ? 1 : 0);
  }
  return numbers;
}

/// Adds an option that takes N numbers in one argument, and hands them to `take`.
template <std::size_t N, class Take>
CLI::Option* add_numbers(CLI::App& app, const std::string& option, const std::string& form,
                         const std::string& help, Take take) {
  return app
      .add_option_function<std::string>(
          option,
          [option, form, take](const std::string& text) {
            take(parse_numbers<N>(option, text, form));
          },
          help)
      ->type_name(form);
}

/// Adds an option whose value is one of a few words.
template <class Enum>
CLI::Option* add_choice(CLI::App& app, const std::string& option, Enum& value,
                        const std::map<std::string, Enum>& words, const std::string& help) {
  std::string list;
  for (const auto& [word, meaning] : words) list += (list.empty() ? "" : "|") + word;
  return app
      .add_option_function<std::string>(
          option,
          [option, words, list, &value](const std::string& text) {
            const auto found = words.find(text);
            if (found == words.end()) {
              throw CLI::ValidationError(option,
                                         fmt::format("\"{}\" is not one of {}", text, list));
            }
            value = found->second;
          },
          help)
      ->type_name(list);
}

Box box_of(const std::array<double, 6>& c, const std::string& option) {
  if (c[0] > c[3] || c[1] > c[4] || c[2] > c[5]) {
    throw CLI::ValidationError(option, "the first corner must not exceed the second in any axis");
  }
  const auto f = [](double value) { return static_cast<float>(value); };
  return {f(c[0]), f(c[1]), f(c[2]), f(c[3]), f(c[4]), f(c[5])};
}

void add_quality(CLI::App& app, EncoderOptions& options) {
  app.add_option_function<int>(
         "--level",
         [&options](int chosen) {
           options.beam.level = chosen;
           options.rcpcc.params = kRcpccLevels.at(static_cast<std::size_t>(chosen));
         },
         "Level of the codec's quality ladder, 0 the finest")
      ->check(CLI::Range(0, static_cast<int>(kBeamLevels.size()) - 1).description(""))
      ->type_name("0..5");
  app.add_option("--max-error", options.beam.max_error_m,
                 fmt::format("Codec beam: no point decodes farther from its place [{}]",
                             options.beam.max_error_m))
      ->check(number_between(0.001, 2.0))
      ->type_name("METRES");
  app.add_option("--target-bytes", options.beam.target_bytes,
                 "Codec beam: as good as fits so many bytes a sweep, the sensor model apart")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 28).description(""))
      ->type_name("N");
  add_choice<Effort>(app, "--effort", options.beam.effort, effort_words(),
                     "Codec beam: time spent to save bytes, in encoding and decoding [default]");
  add_numbers<4>(app, "--params", "AZIMUTH,ELEVATION,THRESHOLD,QSTEP",
                 "Codec rcpcc: steps in degrees, threshold and quantiser step in metres "
                 "[0.5,0.5,0.3,0.2]",
                 [&options, &app](const std::array<double, 4>& p) {
                   if (app.get_option("--codec")->count() == 0) options.codec = CodecId::rcpcc;
                   options.rcpcc.params = {p[0], p[1], p[2], p[3]};
                 });
}

void add_fields(CLI::App& app, BeamOptions& beam) {
  add_choice<Fields>(
      app, "--fields", beam.fields,
      {{"xyz", Fields::xyz}, {"xyzi", Fields::xyzi}, {"all", Fields::all}},
      "Codec beam: which fields are kept: coordinates, intensity, ring and time [all]");
  app.add_option("--intensity-step", beam.intensity_step,
                 "Codec beam: round intensities to multiples of this; 0: keep them exactly [0]")
      ->check(number_between(0.0, 1e6))
      ->type_name("STEP");
  app.add_flag("--keep-order", beam.keep_order,
               "Codec beam: points come back in the order of the input, not firing by firing");
  app.add_flag("--lossless", beam.lossless, "Codec beam: coordinates come back to the bit");
}

void add_view(CLI::App& app, RcpccOptions& rcpcc) {
  add_numbers<2>(app, "--fov-elevation", "MIN,MAX", "Field of view in degrees [-90,90]",
                 [&rcpcc](const std::array<double, 2>& v) {
                   rcpcc.elevation_min_deg = v[0];
                   rcpcc.elevation_max_deg = v[1];
                 });
  add_numbers<2>(app, "--fov-azimuth", "MIN,MAX",
                 "Field of view in degrees; MIN above MAX crosses 180 [-180,180]",
                 [&rcpcc](const std::array<double, 2>& v) {
                   rcpcc.azimuth_min_deg = v[0];
                   rcpcc.azimuth_max_deg = v[1];
                 });
  app.add_option("--max-range", rcpcc.max_range_m,
                 fmt::format("Farther points count as out of view [{}]", rcpcc.max_range_m))
      ->type_name("METRES");
}

}  // namespace

const std::map<std::string, Effort>& effort_words() {
  static const std::map<std::string, Effort> words{
      {"fast", Effort::fast}, {"default", Effort::normal}, {"best", Effort::best}};
  return words;
}

void add_codec_options(CLI::App& app, EncoderOptions& options) {
  RcpccOptions& rcpcc = options.rcpcc;
  add_choice<CodecId>(app, "--codec", options.codec,
                      {{"rcpcc", CodecId::rcpcc}, {"beam", CodecId::beam}},
                      "How sweeps are coded [beam]");
  add_quality(app, options);
  add_fields(app, options.beam);
  app.add_option("--block", rcpcc.block_size,
                 fmt::format("Side of a macroblock in cells [{}]", rcpcc.block_size))
      ->check(CLI::IsMember({4, 8, 16}).description(""))
      ->type_name("4|8|16");
  app.add_option("--region", rcpcc.region_size,
                 fmt::format("Side of an SA-DCT region in cells [{}]", rcpcc.region_size))
      ->check(CLI::IsMember({4, 8, 16, 32}).description(""))
      ->type_name("4|8|16|32");
  add_choice<SurfaceModel>(app, "--model", rcpcc.model,
                           {{"surface", SurfaceModel::surface}, {"plane", SurfaceModel::plane}},
                           "What a block is fitted with [surface]");
  add_choice<UnfitCoding>(app, "--unfit", rcpcc.unfit,
                          {{"sa-dct", UnfitCoding::sa_dct}, {"raw", UnfitCoding::raw}},
                          "How points are coded that no surface fits [sa-dct]");
  add_choice<Rounding>(app, "--quantiser", rcpcc.rounding,
                       {{"nearest", Rounding::nearest}, {"truncate", Rounding::truncate}},
                       "How the quantiser rounds; truncate is for comparison only [nearest]");
  add_choice<CollisionRule>(
      app, "--collision", rcpcc.collision,
      {{"range", CollisionRule::nearest_range}, {"centre", CollisionRule::nearest_centre}},
      "Which point a cell keeps: the one nearest to the cell's centre, or to the "
      "sensor [centre]");
  app.add_option("--zstd", rcpcc.zstd_level, fmt::format("Level of zstd [{}]", rcpcc.zstd_level))
      ->check(CLI::Range(1, 22).description(""))
      ->type_name("1..22");
  add_view(app, rcpcc);
}

void add_crop_options(CLI::App& app, Crop& crop) {
  add_numbers<2>(app, "--crop-range", "MIN,MAX",
                 "Leave out points nearer or farther, metres; MAX 0: no limit",
                 [&crop](const std::array<double, 2>& range) {
                   if (range[0] < 0.0 || (range[1] != 0.0 && range[1] < range[0])) {
                     throw CLI::ValidationError("--crop-range",
                                                "MIN is from 0 to MAX, or MAX is 0 for no limit; "
                                                "give the nearer distance first");
                   }
                   crop.min_range = static_cast<float>(range[0]);
                   crop.max_range = static_cast<float>(range[1]);
                 });
  add_numbers<6>(
      app, "--crop-box", "X0,Y0,Z0,X1,Y1,Z1", "Leave out points outside, metres",
      [&crop](const std::array<double, 6>& corners) { crop.keep = box_of(corners, "--crop-box"); });
  add_numbers<6>(app, "--crop-robot", "X0,Y0,Z0,X1,Y1,Z1",
                 "Leave out points inside: the robot's own body, metres",
                 [&crop](const std::array<double, 6>& corners) {
                   crop.robot = box_of(corners, "--crop-robot");
                 });
}

namespace {

bool is_given(const CLI::App& app, const char* option) {
  const CLI::Option* found = app.get_option_no_throw(option);
  return found != nullptr && found->count() > 0;
}

/// Refuses two options of which one would count for nothing.
void require_one(const CLI::App& app, const char* one, const char* other) {
  if (!is_given(app, one) || !is_given(app, other)) return;
  throw CLI::ValidationError(one, fmt::format("cannot go with {}; leave one of them out", other));
}

}  // namespace

void require_matching(const CLI::App& app, const EncoderOptions& options) {
  constexpr std::array kQualities{"--lossless", "--level", "--max-error", "--target-bytes",
                                  "--params"};
  for (std::size_t i = 0; i < kQualities.size(); ++i) {
    for (std::size_t k = i + 1; k < kQualities.size(); ++k) {
      require_one(app, kQualities[i], kQualities[k]);
    }
  }
  require_one(app, "--lossless", "--intensity-step");
  if (options.beam.fields == Fields::xyz && is_given(app, "--intensity-step")) {
    throw CLI::ValidationError("--intensity-step",
                               "--fields xyz keeps no intensities; leave one of them out");
  }
  const auto refuse = [&](const char* option, std::string_view codec) {
    if (!is_given(app, option)) return;
    throw CLI::ValidationError(option, fmt::format("belongs to codec {}; leave it out, or choose "
                                                   "that codec with --codec {}",
                                                   codec, codec));
  };
  if (options.codec == CodecId::rcpcc) {
    for (const char* option : {"--max-error", "--target-bytes", "--effort", "--fields",
                               "--intensity-step", "--keep-order", "--lossless"}) {
      refuse(option, name(CodecId::beam));
    }
    return;
  }
  for (const char* option :
       {"--params", "--block", "--region", "--model", "--unfit", "--quantiser", "--collision",
        "--zstd", "--fov-elevation", "--fov-azimuth", "--max-range"}) {
    refuse(option, name(CodecId::rcpcc));
  }
}

void require_valid(const EncoderOptions& options) {
  const auto encoder = Encoder::create(options);
  if (!encoder) throw CLI::ValidationError(encoder.error().message);
}

}  // namespace sweepcast::app
