# What tools/house-figures counts: functions, files, sentences, and lists that stand twice.
"""Each function takes the root of the sources and gives (place, size) pairs or plain numbers."""
import ast
import pathlib
import re

CODE = (".cpp", ".hpp")
NO_FUNCTION = re.compile(r"(if|for|while|switch|catch|else|do|namespace|struct|class|enum|union|return|case|default|"
                         r"extern|try)\b|[}#/\[{]|\w+\{")
ENDS_A_STATEMENT = re.compile(r"([;{}>]|(public|private|protected):)$")


def files(root, folders, suffixes=None):
    """Text files of these folders, build products left out."""
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts and (suffixes is None or path.suffix in suffixes):
                yield path


def place(root, path, line):
    return f"{path.relative_to(root)}:{line}"


def cpp_functions(path):
    """(line, length) of each function from the first line of its signature to its closing brace; relies on the layout
    that tools/format-check holds."""
    lines = path.read_text(encoding="utf-8").splitlines()
    at = 0
    while at < len(lines):
        if lines[at].endswith("{") and not lines[at].lstrip().startswith(("//", "#")):
            first = at
            while first and (before := lines[first - 1].strip()) and not ENDS_A_STATEMENT.search(before) and \
                    not before.startswith(("//", "#")):
                first -= 1
            head = re.sub(r"^template <[^{]*?> ", "", " ".join(line.strip() for line in lines[first:at + 1]))
            if "(" in head and not NO_FUNCTION.match(head) and not re.match(r"[^()]*[^=!<>]=\s", head):
                indent = len(lines[first]) - len(lines[first].lstrip())
                while at < len(lines) and not re.match(" " * indent + "}", lines[at]):
                    at += 1
                yield first + 1, at - first + 1
        at += 1


def is_python(path):
    return path.suffix == ".py" or (path.suffix == "" and path.open("rb").readline().rstrip().endswith(b"python3"))


def functions(root, folders):
    """(place, length) of every function in C++ and Python."""
    for path in files(root, folders):
        if path.suffix in CODE:
            for line, length in cpp_functions(path):
                yield place(root, path, line), length
        elif is_python(path):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.FunctionDef):
                    yield place(root, path, node.lineno), node.end_lineno - node.lineno + 1


def file_lengths(root, folders):
    suffixes = (*CODE, ".py", ".sh", ".js", ".cmake", "")
    for path in files(root, folders, suffixes):
        if path.suffix or path.open("rb").read(2) == b"#!":
            yield str(path.relative_to(root)), path.read_text(encoding="utf-8").count("\n")


def pages(root):
    """README and all pages of docs; not what a tool prints whole."""
    return [root / "README.md", *(page for page in sorted((root / "docs").rglob("*.md")) if page.name != "config-keys.md")]


def paragraphs(page):
    """(line, words) of each paragraph and list item of prose; code, tables, headings and pictures are none."""
    inside_code, current, begin = False, [], 0
    for number, line in enumerate([*page.read_text(encoding="utf-8").splitlines(), ""], 1):
        fence = line.lstrip().startswith("```")
        inside_code ^= fence
        other = fence or inside_code or line.lstrip().startswith(("|", "#", "![", "<!--", "$$"))
        item = re.match(r"\s*([-*]|\d+\.) ", line)
        if current and (other or item or not line.strip()):
            yield begin, " ".join(current)
            current = []
        if not other and line.strip():
            begin = begin if current else number
            current.append(line[item.end():] if item else line.strip())


def plain_words(text):
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return [word for word in re.sub(r"`[^`]*`", "code", text).split() if re.search(r"\w", word)]


def sentences(text):
    """Lengths in words. A colon begins no new sentence."""
    text = re.sub(r"`[^`]*`", "code", re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text))
    parts = re.split(r"(?<=[.!?])[)*\"']*\s+(?=[A-Z0-9*`(\"])", text)
    return [count for count in (len(plain_words(part)) for part in parts) if count]


def matches(root, folders, pattern, leave_out=(), suffixes=(*CODE, ".py", "")):
    """Places of lines that match, comments left out."""
    for path in files(root, folders, suffixes):
        if str(path.relative_to(root)) in leave_out:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            code = re.sub(r"^\s*(//|#(?!include)).*|\s//.*", "", line)
            if re.search(pattern, code):
                yield place(root, path, number)


def lists_of(root, folders, names, least, leave_out=(), within=12):
    """Places where at least `least` different names stand as text within `within` lines: a list of them."""
    word = re.compile(r"[\"'](" + "|".join(map(re.escape, names)) + r")[\"']")
    for path in files(root, folders, (*CODE, ".py", "")):
        if str(path.relative_to(root)) in leave_out:
            continue
        found = [(number, name) for number, line in
                 enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1)
                 for name in word.findall(line)]
        end = 0
        for number, _ in found:
            near = {name for line, name in found if number <= line < number + within}
            if len(near) >= least and number > end:
                end = number + within
                yield place(root, path, number)


def effect_names(root):
    """Names of the vocabulary as the structs of the physics visit them."""
    names = set()
    for path in files(root, ("include/pneuservo/elements",), (".hpp",)):
        if path.stem.endswith("effects"):
            names |= set(re.findall(r"v\(Field\{\"(\w+)\", \"\", 0, 0", path.read_text(encoding="utf-8")))
    return sorted(names)
