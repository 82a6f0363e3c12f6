#include "app/plots/gnuplot.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"

namespace fettle::app {
namespace {

// A temporary file that is removed with this object.
class ScratchFile {
 public:
  ScratchFile() {
    std::error_code problem;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(problem);
    if (problem) return;
    path_ = (folder / "fettle-plot-XXXXXX").string();
    const int descriptor = mkstemp(path_.data());
    if (descriptor < 0) {
      path_.clear();
      return;
    }
    close(descriptor);
  }
  ~ScratchFile() {
    if (!path_.empty()) std::remove(path_.c_str());
  }
  ScratchFile& operator=(ScratchFile&&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The output of gnuplot, errors included.
engine::Result<std::string> gnuplot(const std::string& arguments) {
  std::FILE* pipe = popen(("gnuplot " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return engine::failure("gnuplot cannot be started", "plots", "free memory");
  std::string said;
  char buffer[4096];
  for (std::size_t got; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) said.append(buffer, got);
  const int status = pclose(pipe);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    return engine::failure("gnuplot is missing", "plots", "install gnuplot-nox");
  if (status != 0)
    return engine::failure("gnuplot fails: " + said.substr(0, 200), "plots", "please report this");
  return said;
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 32) out += c;
  }
  return out + "\"";
}

std::string ticsOf(char axis, double low, double high) {
  if (high > 200.0 * low) return {};
  std::string tics;
  for (int e = static_cast<int>(std::floor(std::log10(low))); std::pow(10.0, e) <= high; ++e)
    for (const double m : {1.0, 2.0, 5.0})
      if (const double at = m * std::pow(10.0, e); at >= low && at <= high)
        tics += fmt::format("{}{:.3g}", tics.empty() ? "" : ",", at);
  return fmt::format("set {}tics ({})\n", axis, tics);
}

engine::Status plotsCanBeMade() {
  const auto said = gnuplot("--version");
  if (!said) return tl::unexpected(said.error());
  return {};
}

engine::Result<std::string> drawnByGnuplot(const std::string& script) {
  const ScratchFile file;
  if (file.path().empty() || !(std::ofstream(file.path()) << script).flush())
    return engine::failure("no file can be written for a plot", "the folder of temporary files",
                           "free space there, or set TMPDIR to another folder");
  auto said = gnuplot("'" + file.path() + "'");
  if (!said) return said;
  const std::size_t begin = said->find("<svg");
  if (begin == std::string::npos)
    return engine::failure("gnuplot draws nothing: " + said->substr(0, 200), "plots", "please report this");
  return said->substr(begin);
}

engine::Status drawnAsPng(const std::string& script, const std::string& path) {
  auto file = engine::AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const std::string head = kPlotHead;
  const std::string rest = script.starts_with(head) ? script.substr(head.find('\n') + 1) : script;
  const ScratchFile picture;
  const ScratchFile commands;
  if (picture.path().empty() || commands.path().empty() ||
      !(std::ofstream(commands.path())
        << "set terminal pngcairo size 860,480 font 'DejaVu Sans,10' background '#ffffff'\n"
        << "set output " << quoted(picture.path()) << "\n"
        << rest)
           .flush())
    return engine::failure("no file can be written for a plot", "the folder of temporary files",
                           "free space there, or set TMPDIR to another folder");
  if (auto said = gnuplot("'" + commands.path() + "'"); !said) return tl::unexpected(said.error());
  std::ifstream drawn(picture.path(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(drawn), std::istreambuf_iterator<char>()};
  if (!bytes.starts_with("\x89PNG"))
    return engine::failure("gnuplot draws no PNG", "plots", "install gnuplot-nox, or draw an SVG");
  if (auto status = file->write(bytes); !status) return status;
  return file->commit();
}

}  // namespace fettle::app
