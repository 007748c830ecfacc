#!/usr/bin/env python3
"""Every architecture check finds what it is there to find: each is shown a small house with one planted mistake, and
the same house without it. selftest.py [CXX [AR [NM [SIZE]]]]; without a compiler the symbol check is not shown any."""
import contextlib
import io
import pathlib
import subprocess
import sys
import tempfile
import unittest

import house
import includes
import sizes
import symbols
import tree

TOOLS = []
SOUND = {
    "CMakeLists.txt": "project(x)\n",
    "README.md": "`config/a.toml`, `experiment-N.toml`\n",
    "config/a.toml": "",
    "config/experiment-3.toml": "",
    "config/worlds/w.toml": "",
    "core/a.hpp": '#pragma once\n#include <cmath>\n// "throw" and malloc in a comment\n'
                  "struct A { A() noexcept = default; A(const A&) = delete; };\n",
    "core/a.cpp": '#include "core/a.hpp"\n#include <Eigen/Core>\nconst char* f() { return "new \\" throw"; }\n',
    "core/short.cpp": "void g() {}\nvoid h() {}\nvoid i() {}\n",
    "hal/h.hpp": "#pragma once\n#include <thread>\n",
    "firmware/f.hpp": '#pragma once\n#include "core/a.hpp"\n#include "hal/h.hpp"\n',
    "tools/t.hpp": '#pragma once\n#include "firmware/f.hpp"\n#include <iostream>\n',
    "tests/t_test.cpp": '#include "tools/t.hpp"\nTEST(A, B) { GTEST_SKIP() << "no device"; }\n',
}


def body(lines):
    """A block of so many lines, with its braces on the first and the last."""
    return "{\n" + "  f();\n" * (lines - 2) + "}\n"


class Planted(unittest.TestCase):
    def findings(self, check, **planted):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in (SOUND | planted.get("files", {})).items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            with contextlib.redirect_stdout(io.StringIO()):
                return check(root)

    def expect(self, check, name, text, line=None):
        """The sound house passes; with `text` in the file `name` there is one finding, in that file."""
        self.assertEqual([str(f) for f in self.findings(check)], [])
        found = self.findings(check, files={name: text})
        self.assertEqual([f.path for f in found], [name], [str(f) for f in found])
        if line is not None:
            self.assertEqual(found[0].line, line)

    def test_includes_between_rooms(self):
        for name, header in (("core/b.cpp", "firmware/f.hpp"), ("core/b.cpp", "hal/h.hpp"), ("hal/b.cpp", "core/a.hpp"),
                             ("firmware/b.cpp", "tools/t.hpp"), ("tools/b.cpp", "tests/x.hpp"), ("core/b.cpp", "a.hpp"),
                             ("tools/b.cpp", "../core/a.hpp"), ("core/b.cpp", "core/missing.hpp")):
            with self.subTest(name=name, header=header):
                self.expect(includes.check, name, f'\n#  include "{header}"\n', 2)

    def test_includes_of_libraries(self):
        for name, header in (("core/b.cpp", "iostream"), ("core/b.cpp", "thread"), ("core/b.cpp", "vector"),
                             ("core/b.cpp", "new"), ("core/b.cpp", "unistd.h"), ("core/b.cpp", "firmware/f.hpp"),
                             ("tools/b.cpp", "gtest/gtest.h"), ("firmware/b.cpp", "CGAL/basic.h")):
            with self.subTest(name=name, header=header):
                self.expect(includes.check, name, f"#include <{header}>\n", 1)
        self.expect(includes.check, "core/b.cpp", "#include HEADER\n", 1)
        self.expect(includes.check, "core/b.hpp", "struct B {};\n")

    def test_words_in_core(self):
        for statement in ("throw 1;", "auto t = std::chrono::steady_clock::now();", "int* p = new int;", "delete p;",
                          "std::vector<int> v;", "std::mutex m;", "void* p = malloc(3);", "static thread_local int i;"):
            with self.subTest(statement=statement):
                self.expect(includes.check, "core/b.cpp", f"/* a\n */ void f() {{ {statement} }}\n", 2)

    def test_long_files(self):
        self.expect(sizes.check, "tools/b.cpp", "\n" * 601)
        self.assertEqual(self.findings(sizes.check, files={"tools/b.cpp": "\n" * 300}), [])

    def test_long_functions(self):
        heads = ("void f() ", "int A::f(int a = g({1, 2}), B b = {}) const noexcept\n ", "A::A(int b) : b_{b}, c_(b) ",
                 "namespace a {\nstruct B : C {\n  B() noexcept(false)\n  : a_(1) ", "bool operator==(A a) ",
                 "template <typename T>\nclass A final {\n int a = 3;\n public:\n  auto f() -> B<T> ", 'extern "C" int f() ',
                 "struct alignas(64) A { enum class B : int { X }; std::array<int, 2> c{{1, 2}}; void f() ",
                 "constexpr std::array<int, 2> k{1, 2};\nconst char* s = \"{\"; char c = '{'; int n = 1'0;\nvoid f() ")
        for head in heads:
            with self.subTest(head=head):
                closing = "}" * (head.count("struct") + head.count("namespace a") + head.count("class A"))
                line = head.count("\n") + 1
                self.expect(sizes.check, "core/b.cpp", head + body(61) + closing, line)
                self.assertEqual(self.findings(sizes.check, files={"core/b.cpp": head + body(60) + closing}), [])

    def test_long_functions_on_the_whole(self):
        many = "".join(f"void f{i}() " + body(11) for i in range(20))
        self.assertEqual([f.path for f in self.findings(sizes.check, files={"core/b.cpp": many})], ["."])

    def test_tables_are_no_functions(self):
        self.assertEqual(self.findings(sizes.check, files={"core/b.cpp": "const A k = make({" + "\n" * 70 + "});\n"
                                                           "constexpr B l{" + "\n" * 70 + "};\n"}), [])

    def test_entries(self):
        self.expect(tree.entries, "LICENSE", "")
        self.assertEqual([f.path for f in self.findings(tree.entries, files={"docs/a.md": ""})], ["docs"])
        self.assertEqual(self.findings(tree.entries, files={".clang-format": ""}), [])

    def test_words(self):
        for text in ("\ncd /" + "work/main\n", "\nx = '/" + "tmp/y'\n", "\n//TO" + "DO: later\n", "\n# FIX" + "ME\n"):
            with self.subTest(text=text):
                self.expect(tree.words, "tools/b", text, 2)
        self.expect(tree.words, "tests/b", "/" + "root/x")
        harmless = {"tests/b": "/" + "tmp/x", "tools/b": "a/" + "tmp b-XX" + "XX\n"}
        self.assertEqual(self.findings(tree.words, files=harmless), [])

    def test_config(self):
        self.expect(tree.config, "config/b.toml", "")
        self.expect(tree.config, "config/experiment.toml", "")
        with self.assertRaises(SystemExit) as skipped, tempfile.TemporaryDirectory() as folder, \
                contextlib.redirect_stdout(io.StringIO()):
            tree.config(pathlib.Path(folder))
        self.assertEqual(skipped.exception.code, house.SKIPPED)

    def test_skips(self):
        self.expect(tree.skips, "tests/b_test.cpp", "\nTEST(A, DISABLED" + "_B) {}\n", 2)
        self.expect(tree.skips, "tests/b_test.cpp", "TEST(A, B) { GTEST_SKIP" + "(); }\n", 1)

    def test_headers(self):
        twice = {"core/triangle.hpp": "#pragma once\n", "firmware/scan/triangle.hpp": "#pragma once\n"}
        self.assertEqual([f.path for f in self.findings(tree.headers, files=twice)], ["firmware/scan/triangle.hpp"])
        in_tests = {"core/triangle.hpp": "#pragma once\n", "tests/support/triangle.hpp": "#pragma once\n"}
        self.assertEqual(self.findings(tree.headers, files=in_tests), [])

    def test_types(self):
        twice = {"core/a.hpp": "struct Box {\n};\n", "tools/b.hpp": "// a\nenum class Box : char { A };\n"}
        self.assertEqual([(f.path, f.line) for f in self.findings(tree.types, files=twice)], [("tools/b.hpp", 2)])
        other = {"core/a.hpp": "struct Box {\n};\n", "core/b.hpp": "struct Box;\nstruct Lid {\n  struct Box {};\n};\n",
                 "tools/c.cpp": "struct Box {\n};\n", "tests/d.hpp": "struct Box {\n};\n"}
        self.assertEqual(self.findings(tree.types, files=other), [])


class PlantedSymbols(unittest.TestCase):
    def findings(self, source):
        compiler, ar, *readers = TOOLS
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "a.cpp").write_text("int f(int); int f(int a) { return a; }\n")
            (pathlib.Path(folder) / "b.cpp").write_text(source)
            subprocess.run([compiler, "-std=c++20", "-O2", "-c", "a.cpp", "b.cpp"], cwd=folder, check=True)
            subprocess.run([ar, "rcs", "lib.a", "a.o", "b.o"], cwd=folder, check=True)
            return symbols.check(str(pathlib.Path(folder) / "lib.a"), *readers)

    def test_calls(self):
        for source in ("#include <cstdlib>\nvoid* g(unsigned n) { return std::malloc(n); }",
                       "#include <cstdlib>\nvoid* g(void* p) { return std::realloc(p, 9); }",
                       "int* g() { return new int[9]; }", "void g(int* p) { delete p; }",
                       "#include <vector>\nvoid g(std::vector<int>& v) { v.push_back(1); }", "void g() { throw 1; }",
                       "#include <cstdio>\nvoid g() { std::printf(\"%p\", stdout); }",
                       "#include <iostream>\nvoid g() { std::cout << 1; }", "#include <cstdlib>\nvoid g() { std::abort(); }",
                       "#include <unistd.h>\nlong g(char* b) { return read(0, b, 1); }",
                       "#include <chrono>\nlong g() { return std::chrono::steady_clock::now().time_since_epoch().count(); }",
                       "#include <mutex>\nvoid g(std::mutex& m) { m.lock(); }", "int f(char); int g() { return f('a'); }"):
            with self.subTest(source=source):
                found = self.findings(source)
                self.assertTrue(found)
                self.assertTrue(all(f.path == "b.o" for f in found), [str(f) for f in found])

    def test_variables(self):
        for source in ("int count = 3; int g() { return ++count; }", "static int n; int g() { return ++n; }",
                       "thread_local int n; int g() { return ++n; }"):
            with self.subTest(source=source):
                self.assertTrue(any("variables" in str(f) for f in self.findings(source)))

    def test_sound(self):
        source = ("#include <cmath>\n#include <cstring>\nint f(int);\nconst int k[] = {1, 2};\n"
                  "double g(double x, char* p) { std::memset(p, 0, 999); return std::sin(x) + k[f(1)]; }")
        self.assertEqual([str(f) for f in self.findings(source)], [])


if __name__ == "__main__":
    TOOLS = sys.argv[1:]
    if not TOOLS:
        del PlantedSymbols
        print("no compiler given: the symbol check is not tested")
    unittest.main(argv=sys.argv[:1])
