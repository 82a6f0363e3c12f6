#!/usr/bin/python3
"""Makes the sources of the site: collect.py ROOT REFERENCE GUIDE OUT.

ROOT       the source tree; its documents are written for reading there, with links from file to file
REFERENCE  what `fettle reference` wrote
GUIDE      the folder in which scripts/guide ran each page, with the pictures that the pages made
OUT        the folder to make: one tree of Markdown for Sphinx, in which the same links work

A document of docs keeps its path; those above docs are put beside them. Other files that a page links to become pages
with their text. `<!-- site: TEXT -->` in a document is TEXT on the site: what exists only there.
"""

import json
import os
import posixpath
import re
import sys

MOVED = {
    "README.md": "index.md",
    "docs/README.md": "index.md",
    "docs/decisions/README.md": "decisions/index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
FENCE = re.compile(r"^(```.*?^```$)", re.MULTILINE | re.DOTALL)
SITE_ONLY = re.compile(r"<!-- site: (.*?) -->", re.DOTALL)
LINK = re.compile(r"(?<=\]\()([^)\s]+)(?=\))")


class Site:
    def __init__(self, root, guide, out):
        self.root, self.guide, self.out = root, guide, out
        self.shown_files = set()

    def write(self, path, content):
        path = os.path.join(self.out, path)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())

    def read(self, path):
        with open(os.path.join(self.root, path), "rb") as file:
            return file.read()

    def place_of(self, path):
        """Where a file of the tree is on the site; None where there is no such file."""
        if not os.path.isfile(os.path.join(self.root, path)):
            return None
        if path in MOVED:
            return MOVED[path]
        if path.startswith("docs/") and path.endswith((".md", ".svg", ".png")):
            return path.removeprefix("docs/")
        self.shown_files.add(path)
        return f"files/{path}.md"

    def link(self, target, document):
        """The target of a link of a document of the tree, from the same document on the site."""
        if re.match(r"[a-z]+:|#", target):
            return target
        path, hash_mark, anchor = target.partition("#")
        here = posixpath.dirname(self.place_of(document))
        path = posixpath.normpath(posixpath.join(posixpath.dirname(document), path))
        name = path.removeprefix("docs/guide/")
        picture = os.path.join(self.guide, name)
        if path.startswith("docs/guide/") and name.endswith((".png", ".svg")) and os.path.isfile(picture):
            place = f"guide/{name}"
            with open(picture, "rb") as file:
                self.write(place, file.read())
        elif path.startswith("docs/reference/"):
            place = path.removeprefix("docs/")
        else:
            place = self.place_of(path)
        if place is None:
            sys.exit(f"{document}: {target} does not exist")
        return posixpath.relpath(place, here or ".") + hash_mark + anchor

    def add_document(self, document):
        text = SITE_ONLY.sub(r"\1", self.read(document).decode())
        parts = FENCE.split(text)
        for i in range(0, len(parts), 2):
            parts[i] = LINK.sub(lambda match: self.link(match[1], document), parts[i])
        text = "".join(parts)
        if document == "docs/README.md":
            text += contents(text)
        if document == "docs/decisions/README.md":
            text += "\n" + tree(None, re.findall(r"\]\(([a-z-]+)\.md\)", text))
        self.write(self.place_of(document), text)

    def add_shown_files(self):
        for path in sorted(self.shown_files):
            language = {".toml": "toml", ".json": "json"}.get(os.path.splitext(path)[1], "none")
            text = self.read(path).decode().rstrip("\n")
            self.write(f"files/{path}.md", f"---\norphan: true\n---\n# {path}\n\n````{language}\n{text}\n````\n")


def tree(caption, places):
    head = [f":caption: {caption}"] if caption else []
    return "\n".join(["```{toctree}", ":hidden:", *head, "", *places, "```", ""])


def contents(index):
    """The lists of the first page as the tree of pages that the sidebar shows: one order for both."""
    trees = []
    for section in index.split("\n## ")[1:]:
        places = re.findall(r"^- \[.*?\]\((.*?)\.md\)", section, re.MULTILINE)
        trees.append("\n" + tree(section.split("\n")[0], places))
    return "".join(trees)


def add_reference(site, reference):
    """The reference of all commands, a page for each; the benchmarks share one."""
    with open(os.path.join(reference, "reference.md"), encoding="utf-8") as file:
        head, *sections = file.read().split("\n## ")
    with open(os.path.join(reference, "parameters.json"), encoding="utf-8") as file:
        summaries = {c["name"]: c["summary"] for c in json.load(file)["program"]["commands"]}
    pages = {}
    for section in sections:
        words = section.split("\n")[0].split()
        pages.setdefault(words[1] if len(words) > 1 else "", []).append((len(words), section))
    # What the program itself takes is shown on the first page.
    head += "\n" + pages.pop("")[0][1].split("\n\n", 2)[2]
    rows = [f"| [fettle {name}]({name}.md) | {summaries[name]} |\n" for name in pages]
    names = [f"fettle {name} <{name}>" for name in pages]
    title, rest = head.split("\n", 1)
    site.write("reference/index.md", f"# Options of all commands\n{rest}\n## Commands\n\n| command | does |\n|---|---|\n"
               + "".join(rows) + "\n" + tree(None, names))
    for name, parts in pages.items():
        site.write(f"reference/{name}.md", "\n".join("#" * min(words - 1, 2) + " " + text for words, text in parts))


def main():
    root, reference, guide, out = sys.argv[1:]
    site = Site(root, guide, out)
    documents = ["CONTRIBUTING.md", "CHANGELOG.md"]
    for folder, _, names in os.walk(os.path.join(root, "docs")):
        for name in names:
            path = os.path.join(folder, name)
            relative = os.path.relpath(path, root)
            if name.endswith(".md"):
                documents.append(relative)
            elif relative.startswith("docs/pictures/"):
                site.write(site.place_of(relative), site.read(relative))
    for document in sorted(documents):
        site.add_document(document)
    site.add_shown_files()
    add_reference(site, reference)


main()
