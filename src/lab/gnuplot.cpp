#include "lab/gnuplot.hpp"

#include <cstdio>
#include <cstdlib>

#include "io/file.hpp"

namespace sweepcast::lab {
namespace {

bool is_svg(const std::filesystem::path& output) {
  return output.extension() == ".svg";
}

bool has_gnuplot() {
  return std::system("command -v gnuplot >/dev/null 2>&1") == 0;
}

/// Text as one word of a shell's command.
std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

}  // namespace

std::string gnuplot_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

std::string plot_output(const std::filesystem::path& output, int width, int height) {
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  return "set terminal " + std::string(is_svg(output) ? "svg" : "pngcairo") + " size " + size +
         " font 'sans,11'" + (is_svg(output) ? " background 'white'" : "") + "\n";
}

Status check_plot(const std::filesystem::path& output) {
  const std::string file = output.string();
  if (!is_svg(output) && output.extension() != ".png") {
    return fail(ErrorCode::invalid_argument,
                file + ": plots are .png or .svg; give the file one of these extensions");
  }
  if (!has_gnuplot()) {
    return fail(ErrorCode::not_found,
                file + ": gnuplot, which draws the plot, is absent; apt-get install gnuplot-nox");
  }
  return check_writable(output);
}

Status draw_plot(const std::string& script, const std::filesystem::path& output) {
  if (Status possible = check_plot(output); !possible) return possible;
  const std::string file = output.string();
  auto plot = NewFile::create(output);
  if (!plot) return tl::unexpected(plot.error());
  // Through standard output, so that where we are interrupted, gnuplot writes into a file that has
  // no name any more.
  const std::string command = "exec gnuplot >" + shell_word(plot->written_path().string());
  std::FILE* pipe = popen(command.c_str(), "w");
  if (pipe == nullptr) return fail(ErrorCode::io, file + ": gnuplot could not be started");
  const bool sent = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
  const bool drawn = pclose(pipe) == 0;
  if (!sent || !drawn) {
    return fail(ErrorCode::io, file + ": gnuplot failed; its message is above, if it had one");
  }
  return plot->commit(false);
}

}  // namespace sweepcast::lab
