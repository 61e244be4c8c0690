// Errors as values: no exception crosses the public interface.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace sweepcast {

/// What went wrong, for a program; `Error::message` says it for a person.
enum class ErrorCode : std::uint8_t {
  invalid_argument,  ///< an option or a parameter is outside its documented range
  not_found,         ///< a file, folder or component does not exist
  io,                ///< the operating system refused to read or write
  corrupt,           ///< bytes are damaged: a checksum, a size or a value cannot be right
  truncated,         ///< bytes end before the data that they announce
  unsupported,       ///< sound data of a kind or version that this build does not know
  limit,             ///< the data asks for more than a documented cap allows
};

/// Short stable name of a code, as in "corrupt".
[[nodiscard]] std::string_view name(ErrorCode code) noexcept;

/// An error: what, and what to do about it. The message names the object at fault.
struct Error {
  ErrorCode code = ErrorCode::invalid_argument;
  std::string message;
};

/// Either a value or an `Error`.
template <class T>
using Result = tl::expected<T, Error>;

/// Success without a value, or an `Error`.
using Status = Result<void>;

/// Builds the error branch of a `Result`.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace sweepcast
