#!/usr/bin/env python3
# tools/house-figures counts right on planted sources and pages, and what the house has reached stays reached.
import pathlib, subprocess, sys, tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, "tools")
import house_measures as measure
from program import expect

root = pathlib.Path(tempfile.mkdtemp())


def put(name, text):
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


body = "  x += 1;\n" * 49
put("src/a.cpp", f"""// Functions of 51 and 52 lines, a member function, a constructor; a table and a lambda are none.
namespace a {{

int long_one(int x) {{
{body}}}

int longer(int x,
           int y) {{
{body}}}

struct B {{
  explicit B(int x)
      : x_(x) {{
    run();
  }}
  int run() {{
    if (x_ > 0) {{
      return 1;
    }}
    return 0;
  }}
  int x_;
}};

const std::array table{{
    1,
}};
const auto lambda = [](int x) {{
  return x;
}};

}}  // namespace a
""")
put("tools/script", "#!/usr/bin/env python3\n# A script.\ndef five():\n    a = 1\n    b = 2\n    c = 3\n    return a\n")
lengths = sorted(length for _, length in measure.functions(root, ("src", "tools")))
expect(lengths == [4, 5, 6, 51, 52], f"lengths of functions: {lengths}")
expect([one for one in measure.file_lengths(root, ("src", "tools"))][1] == ("tools/script", 7), "lengths of files")

put("README.md", """# A heading of five words

One two three. Four `code with spaces` six! Is [a link of words](far/away.md) counted?
Yes, a line break ends nothing.

| a | table | is | no | prose |

- an item of five words
- another one: it has a colon, and e.g. no second sentence
""")
put("docs/page.md", "```sh\nno prose here\n```\n")
expect([page.name for page in measure.pages(root)] == ["README.md", "page.md"], "pages")
found = [measure.sentences(text) for _, text in measure.paragraphs(root / "README.md")]
expect(found == [[3, 3, 6, 6], [5], [11]], f"words of sentences: {found}")
expect([line for line, _ in measure.paragraphs(root / "README.md")] == [3, 8, 9], "lines of paragraphs")
expect(not list(measure.paragraphs(root / "docs/page.md")), "code is counted as prose")

put("src/b.cpp", '// p1, p2, p3: a comment is no list.\nf("p1"); f("p2");\nconst char* names[] = {"p1", "p2",\n                       "p3"};\n')
expect(list(measure.lists_of(root, ("src",), ["p1", "p2", "p3"], 3)) == ["src/b.cpp:2"], "lists of names")
expect(list(measure.matches(root, ("src",), '"p3"')) == ["src/b.cpp:4"], "places of a text")

done = subprocess.run(["tools/house-figures"], capture_output=True, text=True, timeout=120)
expect(done.returncode in (0, 1), f"tools/house-figures: status {done.returncode}: {done.stderr}")
REACHED = ("functions above 50 lines ", "files above 600 lines", "words a sentence", "words of the longest paragraph", "files to touch for a new verb",
           "files to touch for a new effect", "lists of effects beside their physics", "declarations of one measured signal", "names of one measured signal",
           "comparisons on the name of a control law")
for row in done.stdout.splitlines():
    if row.startswith(REACHED):
        expect(row.endswith("yes"), f"no longer reached; tools/house-figures --places shows where: {row}")
expect(all(any(row.startswith(name) for row in done.stdout.splitlines()) for name in REACHED), f"a row is missing: {done.stdout}")
expect("places" in subprocess.run(["tools/house-figures", "--help"], capture_output=True, text=True).stdout, "--help")
expect(subprocess.run(["tools/house-figures", "--against", "x"], capture_output=True).returncode == 2, "--against without --speed")
