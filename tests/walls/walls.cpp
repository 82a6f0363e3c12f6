#include "tests/walls/walls.h"

#include <regex>
#include <sstream>
#include <stdexcept>

namespace fettle::tests {

namespace {

struct Include {
  std::string header;
  bool quoted = false;
};

std::vector<Include> includesOf(const std::string& text) {
  static const std::regex line(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::vector<Include> found;
  std::istringstream lines(text);
  std::string each;
  std::smatch match;
  while (std::getline(lines, each))
    if (std::regex_search(each, match, line)) found.push_back({match[2], match[1] == "\""});
  return found;
}

std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::set<std::string> setOf(const std::string& text) {
  const auto words = wordsOf(text);
  return {words.begin(), words.end()};
}

// A header of the standard library has neither a dot nor a slash.
bool standard(std::string_view header) {
  return header.find('.') == std::string_view::npos && header.find('/') == std::string_view::npos;
}

}  // namespace

const Walls::Room* Walls::roomOf(std::string_view path) const {
  const Room* best = nullptr;
  for (const Room& room : rooms) {
    if (!path.starts_with(room.name)) continue;
    const char next = path.size() > room.name.size() ? path[room.name.size()] : '/';
    if (next != '/' && next != '.') continue;
    if (best == nullptr || room.name.size() > best->name.size()) best = &room;
  }
  return best;
}

const Walls::Library* Walls::libraryOf(std::string_view header) const {
  if (standard(header)) return nullptr;
  for (const Library& library : libraries)
    for (const std::string& beginning : library.beginnings)
      if (header.starts_with(beginning)) return &library;
  return nullptr;
}

Walls readWalls(const std::string& text) {
  Walls walls;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t colon = line.find(':');
    const auto names = wordsOf(line.substr(0, colon));
    if (colon == std::string::npos || names.empty()) throw std::runtime_error("no row of a table: " + line);
    const std::string rest = line.substr(colon + 1);
    if (names.size() == 2 && names[0] == "library") {
      Walls::Library library{names[1], wordsOf(rest)};
      library.anywhere = library.name.ends_with('*');
      if (library.anywhere) library.name.pop_back();
      walls.libraries.push_back(std::move(library));
    } else if (names.size() == 1) {
      const std::size_t bar = rest.find('|');
      walls.rooms.push_back(
          {names[0], setOf(rest.substr(0, bar)),
           bar == std::string::npos ? std::set<std::string>() : setOf(rest.substr(bar + 1))});
    } else {
      throw std::runtime_error("no row of a table: " + line);
    }
  }
  return walls;
}

std::vector<std::string> wrongIncludes(const Walls& walls, const std::string& path, const std::string& text) {
  const Walls::Room* own = walls.roomOf(path);
  if (own == nullptr) return {path + " lies in no room"};
  std::vector<std::string> wrong;
  for (const Include& include : includesOf(text)) {
    if (const Walls::Room* room = include.quoted ? walls.roomOf(include.header) : nullptr; room != nullptr) {
      if (room != own && !own->rooms.contains(room->name))
        wrong.push_back(path + ": " + own->name + " may not include " + room->name + " (" + include.header +
                        ")");
      continue;
    }
    const Walls::Library* library = walls.libraryOf(include.header);
    if (library == nullptr) {
      // What is generated while building lies next to the room's own files, without a folder.
      const bool generated = include.quoted && include.header.find('/') == std::string::npos;
      if (!generated && !standard(include.header))
        wrong.push_back(path + ": " + include.header + " is of no library that the table knows");
    } else if (!library->anywhere && !own->libraries.contains(library->name)) {
      wrong.push_back(path + ": " + own->name + " may not include " + library->name + " (" + include.header +
                      ")");
    }
  }
  return wrong;
}

Named namedBy(const Walls& walls, const std::string& path, const std::string& text) {
  Named named;
  const Walls::Room* own = walls.roomOf(path);
  for (const Include& include : includesOf(text)) {
    if (const Walls::Room* room = include.quoted ? walls.roomOf(include.header) : nullptr; room != nullptr) {
      if (room != own) named.rooms.insert(room->name);
    } else if (const Walls::Library* library = walls.libraryOf(include.header); library != nullptr) {
      if (!library->anywhere) named.libraries.insert(library->name);
    }
  }
  return named;
}

}  // namespace fettle::tests
