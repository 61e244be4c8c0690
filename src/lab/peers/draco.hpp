// Google's Draco, the codec that comes closest in speed: its kd-tree coder for point clouds.
#pragma once

#include <span>

#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

/// A setting of Draco's kd-tree.
struct DracoOptions {
  int quantisation_bits = 11;  ///< "qp": bits of a coordinate over the cloud's largest extent
  int compression_level = 7;   ///< "cl", 0 to 10: Draco's speed is 10 less this
  /// Above 0: an explicit step of coordinates, metres, counted from the cloud's lowest corner; the
  /// bits are then what its extent needs.
  double step_m = 0.0;
};

/// Makes the codec "draco-kd", setting "qp11 cl7", or "step 0.0231 m"; it codes the finite points'
/// coordinates.
/// Errors: invalid_argument (bits outside 1 to 30, level outside 0 to 10, a step that is no number
/// from 0 up), unsupported (this build has no Draco).
[[nodiscard]] Result<std::unique_ptr<Peer>> make_draco_peer(const DracoOptions& options);

/// 7 to 14 bits, level 7: from a ratio of about 450 to 10. Errors: unsupported.
[[nodiscard]] Result<Peers> draco_ladder();

/// The largest distance of a finite point from where Draco puts it at an explicit step, metres.
[[nodiscard]] double draco_worst_error(const PointCloud& cloud, double step_m);

/// The coarsest explicit step at which no point of any cloud decodes farther than `max_error_m`
/// from its place: half a cube's diagonal of sqrt(3) / 2 steps bounds the error, but clouds rarely
/// reach it. Sought in thousandths of the step that the diagonal gives, whole 10 um.
/// Errors: invalid_argument (bound outside 0.001 to 2 m), limit (coordinates so large that float32
/// has no such bound), unsupported (this build has no Draco).
[[nodiscard]] Result<double> coarsest_draco_step(std::span<const PointCloud> clouds,
                                                 double max_error_m);

}  // namespace sweepcast::lab
