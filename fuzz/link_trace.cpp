// Traces of mahimahi and schedules: the first byte chooses. What is read must be as `Trace` says,
// and a link over it must carry packets in order.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "link/link_model.hpp"
#include "link/trace.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepcast;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto trace = data[0] == 's' ? parse_schedule(text, "fuzz") : parse_mahimahi(text, "fuzz");
  if (!trace) return 0;
  const auto& times = trace->opportunities_us;
  if (trace->period_us <= 0 || times.empty() || times.front() < 0 ||
      times.back() > trace->period_us || !std::is_sorted(times.begin(), times.end())) {
    std::abort();
  }
  LinkModel link(*trace, {.delay_us = 1'000});
  std::int64_t before_us = 0;
  for (std::int64_t now_us = 0; now_us < 10'000; now_us += 1'000) {
    const auto fate = link.send(now_us, 1'400);
    if (!fate || !fate->arrives_us || fate->sent_us < std::max(now_us, before_us) ||
        *fate->arrives_us != fate->sent_us + 1'000) {
      std::abort();
    }
    before_us = fate->sent_us;
  }
  return 0;
}
