#include "app/commands/shards/shard_note.h"

#include <array>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "app/report.h"

namespace fettle::app {

std::string hostName() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  std::string text(name.data());
  for (char& c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
  return text;
}

ShardNote::ShardNote(std::string path, const engine::JobControl& job) : path_(std::move(path)), job_(job) {
  write();
  thread_ = std::thread([this] {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, std::chrono::seconds(2), [this] { return ended_; })) write();
  });
}

ShardNote::~ShardNote() {
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
  }
  wake_.notify_all();
  thread_.join();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void ShardNote::write() const {
  const std::uint64_t total = job_.total();
  const Report note{
      {"host", hostName()},
      {"process", ::getpid()},
      {"stage", job_.stage()},
      {"share", total > 0 ? static_cast<double>(job_.done()) / static_cast<double>(total) : 0.0}};
  std::ofstream(path_, std::ios::trunc) << note.dump() << '\n';
}

}  // namespace fettle::app
