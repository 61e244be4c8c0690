// Why a program cannot listen somewhere, and what helps.
#pragma once

#include <cerrno>

namespace sweepcast::link {

/// What to do where binding a socket failed for this `errno`.
[[nodiscard]] inline const char* listening_remedy(int reason) {
  switch (reason) {
    case EADDRNOTAVAIL:
      return "listen at an address of this machine, or at 0.0.0.0 for all of them";
    case EACCES:
      return "choose a port from 1024 on";
    default:
      return "choose another port, or end the program that has it";
  }
}

}  // namespace sweepcast::link
