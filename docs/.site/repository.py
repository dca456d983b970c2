"""Pages link to what lies beside docs/ in the repository: pictures, READMEs, sources. Those files become part of the site,
so that every link works in a checkout and in the site alike; one that leads nowhere is an error of the strict build."""

import logging
import re
from pathlib import Path

from mkdocs.structure.files import File

root = Path(__file__).resolve().parents[2]
outside = re.compile(r"\]\(\.\./([^)#\s]+)")
log = logging.getLogger("mkdocs.hooks.repository")


def on_files(files, config):
    linked = set()
    for page in files.documentation_pages():
        for path in outside.findall(Path(page.abs_src_path).read_text(encoding="utf-8")):
            if (root / path).is_file():
                linked.add(path)
            else:
                log.warning("%s links to '%s', which is no file of the repository", page.src_path, path)
    for path in sorted(linked):
        files.append(File(path, str(root), config["site_dir"], config["use_directory_urls"]))
    return files


def on_page_markdown(markdown, page, config, files):
    if Path(page.file.abs_src_path).is_relative_to(config["docs_dir"]):
        return outside.sub(r"](\1", markdown)
    return re.sub(r"\]\((\.\./)?docs/", r"](\1", markdown)


def on_nav(nav, config, files):
    """A page that no reader finds is an error, too; but one that begins with _, which waits for its place."""
    for file in files.documentation_pages():
        if file.page not in nav.pages and not file.name.startswith("_"):
            log.warning("%s stands nowhere in the nav of mkdocs.yml", file.src_path)
    return nav
