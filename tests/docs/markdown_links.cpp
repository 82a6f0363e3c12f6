#include "tests/docs/markdown_links.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <sstream>

namespace fettle::tests {
namespace {

// Without code spans: each ends at the next run of as many backticks as it begins with.
std::string withoutSpans(const std::string& text) {
  const auto runAt = [&](std::size_t at) {
    return std::min(text.find_first_not_of('`', at), text.size()) - at;
  };
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t run = text[at] == '`' ? runAt(at) : 0;
    std::size_t end = run == 0 ? std::string::npos : text.find('`', at + run);
    while (end != std::string::npos && runAt(end) != run) end = text.find('`', end + runAt(end));
    if (end != std::string::npos) {
      at = end + run;
    } else {
      out += text.substr(at, std::max<std::size_t>(run, 1));
      at += std::max<std::size_t>(run, 1);
    }
  }
  return out;
}

// The text without fenced blocks, comments and code spans; a fence or a comment leaves its line ends.
std::string withoutCode(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::string out;
  bool fenced = false;
  for (std::string line; std::getline(in, line);) {
    const bool fence = line.starts_with("```");
    if (!fence && !fenced) out += line;
    out += '\n';
    fenced ^= fence;
  }
  for (std::size_t at = out.find("<!--"); at != std::string::npos; at = out.find("<!--", at))
    out.erase(at, out.find("-->", at) - at + 3);
  return withoutSpans(out);
}

std::string anchorOf(std::string_view heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || byte >= 0x80 || c == '-' || c == '_')
      anchor += static_cast<char>(std::tolower(byte));
    else if (c == ' ')
      anchor += '-';
  }
  return anchor;
}

}  // namespace

std::vector<std::string> linksOf(std::string_view text) {
  const std::string prose = withoutCode(text);
  std::vector<std::string> links;
  for (std::size_t at = prose.find("]("); at != std::string::npos; at = prose.find("](", at + 2)) {
    const std::size_t end = prose.find(')', at);
    if (end != std::string::npos) links.push_back(prose.substr(at + 2, end - at - 2));
  }
  return links;
}

std::set<std::string> anchorsOf(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::set<std::string> anchors;
  std::map<std::string, int> seen;
  bool fenced = false;
  for (std::string line; std::getline(in, line);) {
    fenced ^= line.starts_with("```");
    const std::size_t level = line.find_first_not_of('#');
    if (fenced || level == 0 || level == std::string::npos || line[level] != ' ') continue;
    const std::string anchor = anchorOf(std::string_view(line).substr(level + 1));
    const int before = seen[anchor]++;
    anchors.insert(before == 0 ? anchor : anchor + "-" + std::to_string(before));
  }
  return anchors;
}

std::string problemOf(const std::string& document, const std::string& target,
                      const std::function<bool(const std::string&, std::string*)>& read) {
  if (target.find("://") != std::string::npos) return {};
  const std::size_t hash = target.find('#');
  const std::string path = target.substr(0, hash);
  const std::string file =
      path.empty() ? document
                   : (std::filesystem::path(document).parent_path() / path).lexically_normal().string();
  std::string text;
  if (!read(file, &text)) return document + ": " + target + ": there is no " + file;
  if (hash != std::string::npos && !anchorsOf(text).contains(target.substr(hash + 1)))
    return document + ": " + target + ": " + file + " has no such heading";
  return {};
}

}  // namespace fettle::tests
