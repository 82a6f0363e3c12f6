"""Settings of Sphinx for scripts/pages, which makes the folder of sources by collect.py."""

project = "Fettle"
html_title = "Fettle"
extensions = ["myst_parser"]
myst_heading_anchors = 4  # as on GitHub: #heading-in-lower-case
smartquotes = False  # "--option" stays as it is typed
highlight_language = "none"

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["fettle.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_show_sphinx = False
html_use_index = False
