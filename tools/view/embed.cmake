# Writes the files of the page as C++: cmake -DPAGE=FOLDER -DOUT=FILE -P embed.cmake
set(entries "")
set(arrays "")
foreach(file "index.html|/|text/html" "view.css|/view.css|text/css" "view.js|/view.js|text/javascript")
  string(REPLACE "|" ";" parts "${file}")
  list(GET parts 0 name)
  list(GET parts 1 path)
  list(GET parts 2 type)
  file(READ ${PAGE}/${name} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
  string(MAKE_C_IDENTIFIER ${name} id)
  string(APPEND arrays "constexpr char ${id}[] = {${bytes}};\n")
  string(APPEND entries "      {\"${path}\", \"${type}; charset=utf-8\", {${id}, sizeof ${id}}},\n")
endforeach()
file(WRITE ${OUT} "#include \"tools/view/view_server.hpp\"\n\nnamespace slamsensor::tools {\nnamespace {\n\n${arrays}\n}  // namespace\n\n\
const std::array<PageFile, 3>& page_files() {\n  static constexpr std::array<PageFile, 3> kFiles{{\n${entries}  }};\n\
  return kFiles;\n}\n\n}  // namespace slamsensor::tools\n")
