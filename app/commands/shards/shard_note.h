#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "engine/base/job.h"

namespace fettle::app {

/// The name of this machine as files may have it.
[[nodiscard]] std::string hostName();

/// For its lifetime a file that says where a shard runs and how far it is, written again every two seconds: one that is older than
/// kOldNote belongs to a process that is no more. A file that cannot be written is no error.
class ShardNote {
 public:
  ShardNote(std::string path, const engine::JobControl& job);
  ~ShardNote();
  ShardNote& operator=(ShardNote&&) = delete;

 private:
  void write() const;

  std::string path_;
  const engine::JobControl& job_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;  // guarded by mutex_
  std::thread thread_;
};

/// Age of a note beyond which its shard does not run [s].
inline constexpr double kOldNote = 20.0;

}  // namespace fettle::app
