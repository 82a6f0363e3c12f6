#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace fettle::tests {

/// Targets of the links and pictures of a Markdown text, in its order: what stands in "](...)" outside code and
/// comments.
[[nodiscard]] std::vector<std::string> linksOf(std::string_view text);

/// Anchors of the headings of a Markdown text by GitHub's rule: in lower case, without punctuation, blanks as
/// hyphens; one that is there already ends in -1, -2 and so on.
[[nodiscard]] std::set<std::string> anchorsOf(std::string_view text);

/// What is wrong with a link of a document, empty where nothing is.
/// `document`: path of the document from the root, as "docs/formats.md"; `target`: a link of it.
/// `read(path, text)`: whether there is such a file or folder, by its path from the root, and the text of a file.
/// An address of the network counts as right: it is not tried.
[[nodiscard]] std::string problemOf(const std::string& document, const std::string& target,
                                    const std::function<bool(const std::string&, std::string*)>& read);

}  // namespace fettle::tests
