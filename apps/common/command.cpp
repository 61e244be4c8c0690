#include "common/command.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/interruption.hpp"

namespace sweepcast::app {

namespace {

/// One line on standard error; where that is closed, nobody wants to know.
void say(std::string_view kind, std::string_view message) {
  const std::string line = fmt::format("sweepcast: {}: {}\n", kind, message);
  std::fwrite(line.data(), 1, line.size(), stderr);
}

/// Makes the standard streams safe to write files beside. A stream that the caller closed would
/// lend its number to the next file opened, which then took our messages in; so the number is
/// occupied, in the direction that cannot be used. A reader that went away, or a limit on file
/// sizes, shall be an error to report and not a signal that ends the work half done.
void guard_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    const int flags = stream == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    if (open("/dev/null", flags) != stream) std::_Exit(1);  // NOLINT: open is variadic
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

/// Flushes standard output; a result that did not arrive makes a success a failure.
int finish(int exit_status) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_status;
  const int reason = errno;
  if (exit_status != 0) return exit_status;
  if (reason != EPIPE) {  // `| head` has what it wanted
    print_error(
        fmt::format("standard output: {}; the result above is incomplete, send it elsewhere",
                    std::strerror(reason)));
  }
  return 1;
}

/// The subcommand of this name; null where there is none.
CLI::App* find_subcommand(CLI::App& app, const std::string& name) {
  const auto found =
      app.get_subcommands([&](const CLI::App* sub) { return sub->check_name(name); });
  return found.empty() ? nullptr : found.front();
}

/// The program or subcommand that was called without any argument; null where there are some.
CLI::App* called_bare(CLI::App& app, int argc, char** argv) {
  if (argc < 2) return &app;
  return argc == 2 ? find_subcommand(app, argv[1]) : nullptr;
}

/// What the stars of a pattern stand for in a text, up to four; none where it does not match.
std::optional<std::array<std::string_view, 4>> match(std::string_view pattern,
                                                     std::string_view text) {
  std::array<std::string_view, 4> found{};
  for (std::string_view& part : found) {
    const std::size_t star = pattern.find('*');
    if (text.substr(0, star) != pattern.substr(0, star)) return std::nullopt;
    if (star == std::string_view::npos) return found;
    text.remove_prefix(star);
    pattern.remove_prefix(star + 1);
    const std::string_view next = pattern.substr(0, pattern.find('*'));
    const bool is_last = next.size() == pattern.size();
    const std::size_t end = is_last && next.empty() ? text.size() : text.find(next);
    if (end == std::string_view::npos) return std::nullopt;
    part = text.substr(0, end);
    text.remove_prefix(end);
  }
  return text == pattern ? std::optional(found) : std::nullopt;
}

/// What the command line's library says, in the words of the rest of the tool.
std::string in_plain_words(const std::string& message) {
  struct Rewording {
    std::string_view theirs;
    std::string_view ours;
  };
  constexpr std::array<Rewording, 9> kRewordings{{
      {"A subcommand is required", "a command comes first, as in `sweepcast info FILE`"},
      {"*: At least * required but received *",
       "{}: takes {} values, separated by commas, and is given {}"},
      {"* excludes *", "{}: cannot go with {}; leave one of them out"},
      {"*: 1 required * missing", "{}: needs a value, {}"},
      {"*: At Most 1 required but received *", "{}: is given {} times; give it once"},
      {"*: Value * not in range * to *", "{}: {} is not a whole number from {} to {}"},
      {"*: * not in {*}", "{}: {} is not one of {}"},
      {"* is required", "{} is missing; add it"},
      {"Could not convert: * = *", "{}: {} is not a value that it takes"},
  }};
  for (const auto& [theirs, ours] : kRewordings) {
    if (const auto parts = match(theirs, message)) {
      const auto& [first, second, third, fourth] = *parts;
      return fmt::format(fmt::runtime(ours), first, second, third, fourth);
    }
  }
  return message;
}

/// Words that the command does not take; empty where there are none.
std::string unexpected_words(const CLI::App& app) {
  std::string words;
  for (const CLI::App* sub : app.get_subcommands()) {
    for (const std::string& word : sub->remaining()) words += " " + word;
  }
  if (words.empty()) return words;
  return "not expected:" + words + "; check the spelling, or leave it out";
}

/// Says what is wrong with the command line, and where to read how it should be.
int refuse(const CLI::App& app, const CLI::ParseError& error) {
  std::string command = app.get_name();
  for (const CLI::App* sub : app.get_subcommands()) command += " " + sub->get_name();
  const bool is_extra = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
  std::string message = is_extra ? unexpected_words(app) : "";
  if (message.empty()) message = in_plain_words(error.what());
  print_error(fmt::format("{}; see `{} --help`", message, command));
  return 2;
}

/// The option of this name, if its value is a list, each item of which is checked; otherwise null.
CLI::Option* find_list(CLI::App& app, const std::string& word) {
  CLI::Option* option = word.rfind("--", 0) == 0 ? app.get_option_no_throw(word) : nullptr;
  const bool is_list =
      option != nullptr && option->get_delimiter() == ',' && !option->get_allow_extra_args();
  return is_list ? option : nullptr;
}

bool belongs_to(CLI::Option& list, const std::string& word) {
  const auto items = CLI::detail::split(word, ',');
  return std::all_of(items.begin(), items.end(), [&](const std::string& item) {
    return (*list.get_validator())(item).empty();
  });
}

/// Joins lists that were given in words, as in `--codec rcpcc beam`, with commas. What cannot be an
/// item is something else, as a rule an INPUT: CLI11 would take it too.
std::vector<std::string> join_lists(CLI::App& app, const std::vector<std::string>& words) {
  std::vector<std::string> joined;
  CLI::Option* list = nullptr;
  bool has_value = false;
  for (const std::string& word : words) {
    if (list != nullptr && has_value && belongs_to(*list, word)) {
      joined.back() += "," + word;
      continue;
    }
    if (list != nullptr && !has_value) {
      has_value = true;
    } else {
      list = find_list(app, word);
      has_value = false;
    }
    joined.push_back(word);
  }
  return joined;
}

/// No option or input of ours has a meaning when it is empty: a script's variable is unset.
void require_no_empty_word(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& word : option->results()) {
      if (!word.empty()) continue;
      throw CLI::ValidationError(option->get_name(), "is empty; give it a value, or leave it out");
    }
  }
}

int run_command(CLI::App& app, const Command& command, int argc, char** argv) {
  try {
    const std::string first = argv[1];
    CLI::App* sub = find_subcommand(app, first);
    if (first.rfind('-', 0) != 0 && sub == nullptr) {
      throw CLI::ExtrasError(fmt::format("no command is named \"{}\"", first),
                             CLI::ExitCodes::ExtrasError);
    }
    std::vector<std::string> words(argv + 1, argv + argc);
    if (sub != nullptr) words = join_lists(*sub, words);
    std::reverse(words.begin(), words.end());  // as CLI11 wants them
    app.parse(words);
    if (sub != nullptr) require_no_empty_word(*sub);
    const Status status = command ? command() : Status{};
    if (status) return 0;
    print_error(status.error().message);
    return 1;
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : refuse(app, error);
  } catch (const std::exception& error) {  // a library's; ours come as Status
    print_error(error.what());
    return 1;
  }
}

}  // namespace

int run(CLI::App& app, const Command& command, int argc, char** argv) {
  guard_standard_streams();
  if (const CLI::App* bare = called_bare(app, argc, argv)) {
    const std::string help = bare->help(bare == &app ? "" : app.get_name());
    std::fwrite(help.data(), 1, help.size(), stderr);
    return 2;
  }
  remove_unfinished_on_signals();
  return finish(run_command(app, command, argc, argv));
}

void print_error(std::string_view message) {
  say("error", message);
}

void print_warning(std::string_view message) {
  say("warning", message);
}

void print_note(std::string_view message) {
  say("note", message);
}

void print_json(const nlohmann::ordered_json& value) {
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  const std::string text = value.dump(2, ' ', false, kReplace) + "\n";
  std::fwrite(text.data(), 1, text.size(), stdout);  // `run` checks the stream at the end
}

}  // namespace sweepcast::app
