"""Hooks of MkDocs (mkdocs.yml): what its configuration cannot say.

- A navigation entry `FOLDER/*` stands for all pages of that folder, by name.
- A link from a page to a file of the repository that is no page becomes the file's name, for the site holds pages only.
  scripts/check-docs has checked that the file exists.
"""
import pathlib
import posixpath
import re


def expand(item, docs):
    if isinstance(item, list):
        return [one for part in item for one in as_list(expand(part, docs))]
    if isinstance(item, dict):
        return {title: expand(value, docs) for title, value in item.items()}
    if item.endswith("/*"):
        return sorted(str(page.relative_to(docs)) for page in (docs / item[:-2]).glob("*.md") if page.name != "README.md")
    return item


def as_list(item):
    return item if isinstance(item, list) else [item]


def on_config(config):
    config["nav"] = expand(config["nav"], pathlib.Path(config["docs_dir"]))
    return config


def on_page_markdown(markdown, page, config, files):
    folder = posixpath.dirname(page.file.src_path)

    def link(match):
        text, target = match.groups()
        path = target.partition("#")[0]
        inside = posixpath.normpath(posixpath.join(folder, path)) if path else ""
        if "://" in target or not inside.startswith(".."):
            return match.group(0)
        return text if text.startswith("`") else f"{text} (`{inside.removeprefix('../')}`)"

    return re.sub(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)", link, markdown)
