#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <sys/types.h>
#include <nlohmann/json.hpp>

namespace fettle::tests {

/// `fettle view` while it runs: what it reports (--events) is read as it comes. Ends it with this object.
/// Threading: one thread; a thread of its own reads.
class ViewProgram {
 public:
  using State = nlohmann::json;
  /// Far beyond what a busy machine needs: a test that waits this long has failed.
  static constexpr std::chrono::seconds kPatience{60};

  /// Whether the validation layers watch it; they take their time.
  enum class Watched { kYes, kNo };
  /// Starts `fettle view` with these arguments besides --events, --json and --validate. `environment` is set
  /// for it alone.
  explicit ViewProgram(std::vector<std::string> arguments,
                       const std::map<std::string, std::string>& environment = {},
                       Watched watched = Watched::kYes);
  ~ViewProgram();
  ViewProgram(const ViewProgram&) = delete;
  ViewProgram& operator=(const ViewProgram&) = delete;

  /// Waits until the program has reported such a state, looking at every one since the last that was waited
  /// for, that one included. Throws when it does not come: nothing after it makes sense.
  State until(const std::string& what, const std::function<bool(const State&)>& is,
              std::chrono::seconds patience = kPatience);
  /// The newest state reported; null before the first.
  [[nodiscard]] State now();
  /// Shows every state reported since the last call of this, those that until() has looked at among them, without waiting for more;
  /// what was reported before the newest is gone afterwards. For those who drive the program for a long time.
  void each(const std::function<void(const State&)>& look);
  /// Skips what was reported up to now: until() looks at what comes from here on, beginning with the newest.
  void skipToNewest();

  /// Whether all that it says has ended: it has, or is about to.
  [[nodiscard]] bool ended();

  void signal(int number) const;
  /// Waits for its end. Exit status; 128 + signal when a signal ended it. Throws when it does not end.
  int wait();
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] const std::string& err() const { return err_; }  ///< after wait()
  [[nodiscard]] const std::string& out() const { return out_; }
  /// Its report, after wait(); an empty object when it printed none.
  [[nodiscard]] State report() const;

 private:
  [[nodiscard]] std::string lastReported() const;  // mutex_ is held

  void listen();

  pid_t pid_ = -1;
  int status_ = -1;
  int out_end_ = -1, err_end_ = -1, events_end_ = -1;
  std::string out_, err_;
  std::mutex mutex_;
  std::condition_variable reported_;
  std::vector<State> states_;  // guarded by mutex_
  bool ended_ = false;         // guarded by mutex_
  std::size_t seen_ = 0;       // by until()
  std::size_t shown_ = 0;      // by each()
  std::jthread listener_;
};

}  // namespace fettle::tests
