"""The README taken apart: its commands, its names in backticks, its tables."""
import pathlib
import re


class Readme:
    def __init__(self, tree):
        self.tree = pathlib.Path(tree)
        self.text = (self.tree / "README.md").read_text(encoding="utf-8")
        self.lines = self.text.splitlines()

    def section(self, title):
        """From the heading that begins so to the next."""
        found = re.search(rf"^## {re.escape(title)}.*?$(.*?)(?=^## |\Z)", self.text, re.MULTILINE | re.DOTALL)
        if not found:
            raise AssertionError(f"the README has no section {title!r}")
        return found[1]

    def indented(self, title):
        """The lines of a section's listings, without their comments."""
        return [re.sub(r"\s{2,}.*", "", line.strip()) if title == "The daemon" else re.sub(r"\s+#.*", "", line.strip())
                for line in self.section(title).splitlines() if line.startswith("    ") and line.strip()]

    def quoted(self):
        """What stands in backticks, in the order of the text."""
        return re.findall(r"`([^`\n]+)`", self.text)

    def table(self, title):
        """Rows of the table in a section, without its head."""
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in self.section(title).splitlines()
                if line.startswith("|")]
        return rows[2:]
