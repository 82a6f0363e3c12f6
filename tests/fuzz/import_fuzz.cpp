// One harness under two generators: libFuzzer (scripts/fuzz) through the entry below, and the plain one of
// damage_test.cpp in every build.

#include "tests/fuzz/import_fuzz.h"
#include "engine/formats/formats.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <unistd.h>

namespace fettle::tests {

namespace {

// In memory where there is such a folder; the process' own number, as several run side by side.
std::string pathFor(const std::string& extension) {
  static const std::string folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
  return folder + "/fettle-fuzz-" + std::to_string(getpid()) + extension;
}

[[noreturn]] void fail(const char* what, const std::string& detail) {
  std::fprintf(stderr, "%s: %s\n", what, detail.c_str());
  std::abort();
}

}  // namespace

void importBytes(const std::string& extension, const std::uint8_t* bytes, std::size_t count) {
  const std::string path = pathFor(extension);
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  engine::JobControl job;
  const auto scan = engine::importField(path, {}, job);
  std::remove(path.c_str());
  if (!scan) {
    if (scan.error().kind != engine::ErrorKind::kInput || scan.error().what.empty() ||
        scan.error().line().find('\n') != std::string::npos)
      fail("no refusal of one line", scan.error().line());
    return;
  }
  const engine::Grid& grid = scan->field.grid();
  const engine::FieldSummary summary = engine::summarize(scan->field);
  if (grid.width < 1 || grid.height < 1 || !(grid.spacing_x > 0.0) || !(grid.spacing_y > 0.0))
    fail("no grid", scan->format);
  // A scan of holes alone opens, and says so.
  const auto says_so = [](const std::string& warning) { return warning.starts_with("there is no height"); };
  if (!(summary.min <= summary.max) && std::ranges::none_of(scan->warnings, says_so))
    fail("no height and no warning", scan->format);
}

}  // namespace fettle::tests

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  static const char* const extension = std::getenv("FETTLE_FUZZ_EXTENSION");
  fettle::tests::importBytes(extension != nullptr ? extension : ".tif", bytes, count);
  return 0;
}
