// Included ahead of everything where the standard library is of before 2021, as that of Debian 12's
// emscripten: it lacks std::bit_cast, though the compiler has it.
#pragma once

#include <bit>

#ifndef __cpp_lib_bit_cast
namespace std {  // NOLINT(cert-dcl58-cpp): where the sources look for it
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}
}  // namespace std
#endif
