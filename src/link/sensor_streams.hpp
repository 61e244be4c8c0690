// The sensors of a sender, and what its receiver knows of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "link/feedback.hpp"

namespace sweepcast::link {

class SensorStreams {
 public:
  /// The number of a sensor's stream, a new one where there is none. Error limit: the 17th.
  [[nodiscard]] Result<std::uint8_t> number_of(std::string_view sensor);

  /// Puts the sensor's model into the frame where the receiver lacks it, and leaves it out where it
  /// has it. The frame then is valid until the next call. `model`: the one that the frame needs
  /// beside itself, 0 for none. Errors: those of `parse_frame_header`.
  [[nodiscard]] Status prepare_frame(std::uint8_t number, std::span<const std::byte>& frame,
                                     std::uint32_t& model);

  /// Takes note of the models that the receiver holds.
  void confirm(std::span<const StreamReport> reports);
  /// A new connection: the receiver holds none.
  void begin_connection();

  [[nodiscard]] std::size_t size() const { return streams_.size(); }

 private:
  struct Stream {
    std::string sensor;
    std::vector<std::byte> model;  ///< of the newest frame that had one
    std::uint32_t model_id = 0;
    std::uint32_t confirmed = 0;  ///< model that the receiver holds
  };
  std::vector<Stream> streams_;
  std::vector<std::byte> rewritten_;
};

}  // namespace sweepcast::link
