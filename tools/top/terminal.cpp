#include "tools/top/terminal.hpp"

#define NCURSES_NOMACROS  // its macros are named clear, move, erase
#include <cstdio>
#include <cstdlib>
#include <curses.h>

namespace slamsensor::tools {
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
