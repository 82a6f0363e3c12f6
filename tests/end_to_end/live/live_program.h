#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>
#include <nlohmann/json.hpp>

namespace fettle::tests {

/// The built program while it runs: keys go in, what it says comes out, signals are sent. One thread.
class LiveProgram {
 public:
  /// Starts it with these arguments, `hid_folder` as the place of fake HID devices, and the drop-in hidapi. `inverse3`: where the
  /// Inverse3's service is looked for; by default there is none.
  LiveProgram(std::vector<std::string> arguments, const std::string& hid_folder,
              const std::string& inverse3 = "localhost:1");
  ~LiveProgram();  ///< kills it if it still runs
  LiveProgram(const LiveProgram&) = delete;
  LiveProgram& operator=(const LiveProgram&) = delete;

  void press(char key);
  /// Waits until it has said `text` on stderr since the last wait that succeeded; false after `patience` or
  /// when it has ended without.
  [[nodiscard]] bool says(const std::string& text, std::chrono::seconds patience = std::chrono::seconds(60));
  /// Whether it has said it since then, by now; as says() otherwise.
  [[nodiscard]] bool said(const std::string& text);
  void signal(int number) const;
  /// Waits for its end. Exit status; 128 + signal when a signal ended it.
  int wait();

  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] const std::string& out() const { return out_; }
  [[nodiscard]] const std::string& err() const { return err_; }
  /// Its report, after wait(); a null when it printed none.
  [[nodiscard]] nlohmann::json report() const;

 private:
  /// Takes in what it said; waits at most `ms` for something. False when both streams are closed.
  bool listen(int ms);

  pid_t pid_ = -1;
  int keys_ = -1;
  int out_end_ = -1;
  int err_end_ = -1;
  std::string out_;
  std::string err_;
  std::size_t heard_ = 0;  // of err_
  int status_ = -1;
};

}  // namespace fettle::tests
