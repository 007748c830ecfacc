#include "tools/output/text_output.hpp"

#include "firmware/store/map_file.hpp"
#include "tools/input/text.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <fcntl.h>
#include <string_view>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace slamsensor::tools {
namespace {

// The longest double has 309 digits before the point; fixed notation of the smallest has 17 + 324 behind it.
constexpr std::size_t kTextMax = 512;

void append_without_negative_zero(std::string& out, std::string_view text) {
  const bool is_zero = text.find_first_not_of("-0.") == std::string_view::npos;
  if (is_zero && !text.empty() && text.front() == '-') text.remove_prefix(1);
  out.append(text);
}

}  // namespace

void append_fixed(std::string& out, double value, int decimals) {
  char text[kTextMax];
  const auto end =
      std::to_chars(text, text + kTextMax, value, std::chars_format::fixed, std::clamp(decimals, 0, 17)).ptr;
  append_without_negative_zero(out, {text, static_cast<std::size_t>(end - text)});
}

void append_shortest(std::string& out, double value) {
  char text[kTextMax];
  const auto end = std::to_chars(text, text + kTextMax, value, std::chars_format::fixed).ptr;
  append_without_negative_zero(out, {text, static_cast<std::size_t>(end - text)});
}

void append_general(std::string& out, double value, int digits) {
  char text[kTextMax];
  const auto end =
      std::to_chars(text, text + kTextMax, value, std::chars_format::general, std::clamp(digits, 1, 17)).ptr;
  append_without_negative_zero(out, {text, static_cast<std::size_t>(end - text)});
}

std::string fixed_text(double value, int decimals) {
  std::string out;
  append_fixed(out, value, decimals);
  return out;
}

namespace {

using Path = std::filesystem::path;

constexpr int kTemporaryNamesMax = 100;

std::string_view advice(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or name a folder on another disk";
    case EACCES:
    case EPERM:
    case EROFS:
      return "make the folder writable or name another one";
    case ENOENT:
    case ENOTDIR:
      return "create the folder or correct the path";
    case EISDIR:
      return "name a file, not a folder";
    case ENAMETOOLONG:
      return "choose a shorter name";
    case EPIPE:
      return "the reader at the other end has gone";
    default:
      return "check the disk and try again";
  }
}

tl::unexpected<OutputError> failure(const Path& path, int error) {
  return tl::unexpected(OutputError{"cannot write " + path.string() + ": " +
                                    std::generic_category().message(error) + "; " +
                                    std::string(advice(error))});
}

// 0 or errno.
int write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

// 0 or errno; the file is closed in every case. Pipes and some file systems know no fsync and say EINVAL or
// ENOTSUP.
int write_and_close(int file, std::string_view bytes) {
  int error = write_all(file, bytes);
  if (error == 0 && ::fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP) error = errno;
  if (::close(file) != 0 && error == 0) error = errno;
  return error;
}

tl::expected<void, OutputError> write_in_place(const Path& path, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return failure(path, errno);
  if (const int error = write_and_close(file, bytes); error != 0) return failure(path, error);
  return {};
}

// The name does not contain the target's own, which may already be as long as the file system allows.
Path temporary_name(const Path& folder, int attempt) {
  return folder / (".slamsensor-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part");
}

struct Temporary {
  Path path;
  int file = -1;
};

tl::expected<Temporary, int> create_temporary(const Path& folder) {
  int error = EEXIST;
  for (int attempt = 0; attempt < kTemporaryNamesMax && error == EEXIST; ++attempt) {
    const Path name = temporary_name(folder, attempt);
    const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) return Temporary{name, file};
    error = errno;
  }
  return tl::unexpected(error);
}

tl::expected<void, OutputError> replace(const Path& path, std::string_view bytes) {
  const Path folder = path.has_parent_path() ? path.parent_path() : Path(".");
  const auto temporary = create_temporary(folder);
  if (!temporary) return failure(path, temporary.error());
  int error = write_and_close(temporary->file, bytes);
  if (error == 0 && ::rename(temporary->path.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return {};
  ::unlink(temporary->path.c_str());
  return failure(path, error);
}

bool is_map(std::string_view bytes) {
  return bytes.size() >= firmware::kMapMagic.size() &&
         std::equal(firmware::kMapMagic.begin(), firmware::kMapMagic.end(), bytes.begin(),
                    [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); });
}

/// Whether there is a map of the sensor at `path`, by its name or by how it begins.
bool has_map(const Path& path) {
  if (path.extension() == ".slammap") {
    return true;
  }
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) {
    return false;
  }
  const auto start = read_file(path, firmware::kMapMagic.size());
  return start && is_map(*start);
}

tl::unexpected<OutputError> refuse_map(const Path& path) {
  return tl::unexpected(OutputError{path.string() +
                                    ": it is the name of a map of the sensor, or a map itself, which nothing "
                                    "else may replace; name another output"});
}

/// Whether what is written to one replaces what was written to the other; a device takes both.
bool is_one_file(const Path& a, const Path& b) {
  std::error_code none;
  return !a.empty() && !b.empty() && (!std::filesystem::exists(a, none) || is_regular_file(a, none)) &&
         weakly_canonical(std::filesystem::absolute(a, none), none) ==
             weakly_canonical(std::filesystem::absolute(b, none), none);
}

}  // namespace

tl::expected<void, OutputError> check_outputs(std::span<const Path> outputs, std::span<const Path> inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto others = outputs.first(i);
    const auto same = std::find_if(others.begin(), others.end(),
                                   [&](const Path& other) { return is_one_file(outputs[i], other); });
    if (same != others.end()) {
      return tl::unexpected(OutputError{outputs[i].string() + ": it is the output " + same->string() +
                                        " too, which would be overwritten; name another output"});
    }
  }
  for (const Path& output : outputs) {
    for (const Path& input : inputs) {
      std::error_code none;  // what is not there is no input
      if (!output.empty() && !input.empty() && std::filesystem::equivalent(output, input, none)) {
        return tl::unexpected(OutputError{output.string() + ": it is the input " + input.string() +
                                          ", which would be overwritten; name another output"});
      }
    }
    if (!output.empty() && has_map(output)) {
      return refuse_map(output);
    }
  }
  return {};
}

tl::expected<void, OutputError> write_file(const Path& path, std::string_view bytes) {
  if (!is_map(bytes) && has_map(path)) return refuse_map(path);
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return replace(path, bytes);
  if (S_ISDIR(status.st_mode)) return failure(path, EISDIR);
  if (!S_ISREG(status.st_mode)) return write_in_place(path, bytes);
  // An existing file that may not be written must not be replaced just because its folder may be.
  if (::access(path.c_str(), W_OK) != 0) return failure(path, errno);
  std::error_code error;
  const Path target = std::filesystem::canonical(path, error);
  if (error) return failure(path, error.value());
  return replace(target, bytes);
}

}  // namespace slamsensor::tools
