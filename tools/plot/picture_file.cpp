#include "tools/plot/picture_file.hpp"

#include <cerrno>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace slamsensor::tools {

tl::expected<void, OutputError> draw_png(const std::filesystem::path& svg, const std::filesystem::path& png) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::execlp("rsvg-convert", "rsvg-convert", "--zoom", "2", "--background-color", "white", "-o", png.c_str(),
             svg.c_str(), static_cast<char*>(nullptr));
    ::_exit(errno == ENOENT ? 127 : 126);
  }
  int status = 0;
  const bool has_ended = child > 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status);
  if (has_ended && WEXITSTATUS(status) == 0) {
    return {};
  }
  return tl::unexpected(
      OutputError{png.string() + ": rsvg-convert " +
                  (has_ended && WEXITSTATUS(status) == 127
                       ? "is not installed; apt install librsvg2-bin, or be content with the SVG"
                       : "could not draw it from " + svg.string())});
}

tl::expected<void, OutputError> write_picture(const std::filesystem::path& path, std::string_view svg) {
  if (path.extension() != ".png") {
    return write_file(path, svg);
  }
  std::filesystem::path beside = path;
  beside.replace_extension(".svg");
  if (auto written = write_file(beside, svg); !written) {
    return written;
  }
  return draw_png(beside, path);
}

}  // namespace slamsensor::tools
