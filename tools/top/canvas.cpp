#include "tools/top/canvas.hpp"

#include "tools/output/text_output.hpp"

#define NCURSES_NOMACROS  // its macros are named clear, move, erase
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <curses.h>

namespace slamsensor::tools {

Canvas::Canvas(int width, int height)
    : width_(std::clamp(width, 0, kSizeMax)),
      height_(std::clamp(height, 0, kSizeMax)),
      cells_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
}

void Canvas::put(int x, int y, std::string_view text, CellStyle style) {
  if (y < 0 || y >= height_) {
    return;
  }
  for (const char c : text) {
    if (x >= width_) {
      return;
    }
    if (x >= 0) {
      cells_[index(x, y)] = {c >= ' ' && c <= '~' ? c : '?', style};
    }
    ++x;
  }
}

std::string Canvas::text() const {
  std::string out;
  for (int y = 0; y < height_; ++y) {
    std::string line;
    for (int x = 0; x < width_; ++x) {
      line += at(x, y).c;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  }
  return out;
}

namespace {

std::string pair_text(long long first, char separator, long long second, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%lld%c%02lld %s", first, separator, second, unit);
  return text;
}

}  // namespace

int put_lines(Canvas& canvas, const CanvasBox& box, const TextLines& lines) {
  const auto rows = std::min(lines.size(), static_cast<std::size_t>(std::max(0, box.height)));
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string_view text = lines[i].text;
    canvas.put(box.x, box.y + static_cast<int>(i),
               text.substr(0, static_cast<std::size_t>(std::max(0, box.width))), lines[i].style);
  }
  return box.y + static_cast<int>(rows);
}

std::string duration_text(hal::Stamp time) {
  const double seconds = hal::to_seconds(time);
  if (std::abs(seconds) < 0.001) {
    return fixed_text(seconds * 1e6, 0) + " us";
  }
  if (std::abs(seconds) < 1.0) {
    return fixed_text(seconds * 1e3, 1) + " ms";
  }
  if (std::abs(seconds) < 60.0 || seconds < 0.0) {
    return fixed_text(seconds, 1) + " s";
  }
  const auto whole = static_cast<long long>(seconds);
  if (whole < 3600) {
    return pair_text(whole / 60, ':', whole % 60, "min");
  }
  if (whole < 4 * 86'400) {
    return pair_text(whole / 3600, ':', whole / 60 % 60, "h");
  }
  return std::to_string(whole / 86'400) + " d " + std::to_string(whole / 3600 % 24) + " h";
}

std::string amount_text(double value) {
  constexpr std::array<std::string_view, 4> kMultiples = {"", " k", " M", " G"};
  std::size_t multiple = 0;
  while (std::abs(value) >= 999.5 && multiple + 1 < kMultiples.size()) {
    value /= 1000.0;
    ++multiple;
  }
  const bool is_short = multiple == 0 ? value == std::floor(value) : std::abs(value) >= 99.5;
  return fixed_text(value, is_short ? 0 : 1) + std::string(kMultiples[multiple]);
}

namespace {

enum ColourPair : short { kGood = 1, kWarning, kBad };

bool wants_colours() {
  const char* const refused = std::getenv("NO_COLOR");
  return refused == nullptr || *refused == '\0';
}

chtype colour(ColourPair pair) {
  return static_cast<chtype>(COLOR_PAIR(pair));
}

chtype attributes(CellStyle style, bool has_colours) {
  switch (style) {
    case CellStyle::Plain:
      return A_NORMAL;
    case CellStyle::Bold:
      return A_BOLD;
    case CellStyle::Dim:
      return A_DIM;
    case CellStyle::Good:
      return has_colours ? colour(kGood) : A_BOLD;
    case CellStyle::Warning:
      return has_colours ? colour(kWarning) : A_BOLD;
    case CellStyle::Bad:
      return has_colours ? colour(kBad) | A_BOLD : A_REVERSE;
    case CellStyle::Inverse:
      return A_REVERSE;
  }
  return A_NORMAL;
}

}  // namespace

tl::expected<std::unique_ptr<Terminal>, std::string> Terminal::open() {
  SCREEN* const handle = ::newterm(nullptr, stdout, stdin);
  if (handle == nullptr) {
    const char* const name = std::getenv("TERM");
    return tl::unexpected("the terminal \"" + std::string(name != nullptr ? name : "") +
                          "\" is not known; set TERM, or use --once");
  }
  return std::unique_ptr<Terminal>(new Terminal(handle));
}

Terminal::Terminal(::screen* handle) : handle_(handle) {
  ::cbreak();
  ::noecho();
  ::nonl();
  ::nodelay(stdscr, TRUE);
  ::keypad(stdscr, TRUE);
  ::set_escdelay(25);
  ::curs_set(0);
  has_colours_ = wants_colours() && ::has_colors() && ::start_color() == OK;
  if (has_colours_) {
    ::use_default_colors();
    ::init_pair(kGood, COLOR_GREEN, -1);
    ::init_pair(kWarning, COLOR_YELLOW, -1);
    ::init_pair(kBad, COLOR_RED, -1);
  }
}

Terminal::~Terminal() {
  ::endwin();
  ::delscreen(handle_);
}

int Terminal::width() const {
  return ::getmaxx(stdscr);
}

int Terminal::height() const {
  return ::getmaxy(stdscr);
}

void Terminal::show(const Canvas& canvas) {
  ::werase(stdscr);
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      const Canvas::Cell& cell = canvas.at(x, y);
      // The last cell of a screen cannot be added without a line feed; it is inserted instead.
      const chtype shown =
          static_cast<chtype>(static_cast<unsigned char>(cell.c)) | attributes(cell.style, has_colours_);
      if (x == canvas.width() - 1) {
        ::mvinsch(y, x, shown);
      } else {
        ::mvaddch(y, x, shown);
      }
    }
  }
  ::wrefresh(stdscr);
}

TopKey Terminal::next_key() {
  switch (::wgetch(stdscr)) {
    case ERR:
      return TopKey::None;
    case 'q':
    case 'Q':
    case 3:
      return TopKey::Quit;
    case '1':
      return TopKey::Sensor;
    case '2':
      return TopKey::Counters;
    case '3':
      return TopKey::Channels;
    case '\t':
      return TopKey::NextPage;
    case 'k':
    case KEY_UP:
      return TopKey::Up;
    case 'j':
    case KEY_DOWN:
      return TopKey::Down;
    default:
      return TopKey::Redraw;
  }
}

}  // namespace slamsensor::tools
