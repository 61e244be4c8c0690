#include "rate/strategy.hpp"

#include <string>

namespace sweepcast {
namespace {

class Fixed final : public Strategy {
 public:
  explicit Fixed(std::size_t level) : level_(level) {}
  Choice decide(const LinkView& /*view*/) override { return {.level = level_}; }

 private:
  std::size_t level_;
};

}  // namespace

std::unique_ptr<Strategy> make_fixed(std::size_t level) {
  return std::make_unique<Fixed>(level);
}

Result<std::unique_ptr<Strategy>> make_strategy(std::string_view name, CodecId codec) {
  if (name == "paper") return make_paper();
  if (name == "bola") return make_bola();
  if (name == "mpc") return make_mpc();
  if (name == "budget") return codec == CodecId::beam ? make_budget() : make_planned_levels();
  if (name.size() == 7 && name.starts_with("fixed:") && name[6] >= '0' &&
      name[6] < '0' + static_cast<char>(kLevels)) {
    return make_fixed(static_cast<std::size_t>(name[6] - '0'));
  }
  return fail(ErrorCode::invalid_argument,
              std::string(name) + ": no such strategy; there are " + std::string(kStrategyNames));
}

}  // namespace sweepcast
