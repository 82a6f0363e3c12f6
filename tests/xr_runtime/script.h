#pragma once

#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace fettle::tests::xr {

/// Where something is: metres in the room, y up, -z ahead; degrees about y (to the left) and about x (up).
struct Place {
  double x = 0.0, y = 0.0, z = 0.0, yaw_deg = 0.0, pitch_deg = 0.0;
};

/// What happens in which frame, read from a text of lines, `#` for comments:
///
///   size 320 360                     pixels of one eye's picture
///   rate 90                          frames per second
///   0 head 0 1.6 0 0 -30             place from this frame on; between two such lines on the straight way
///   0 left ... / right ...           the same of a hand; one without a place is not tracked
///   10 right trigger 0.7             from this frame on; also squeeze, scroll (-1 .. 1), and button 0 or 1
///   10 right infer 1                 its place is guessed, and not tracked, until "infer 0"; "broken 1": it is no number
///   20 keep                          the pictures of this frame become files
///   30 hide, show, stop, lose        the session: no longer seen, seen again, asked to end, lost
///   30 end                           it ends after this frame at once: no frame between its focus and its end
///   30 busy                          it still reads its images in this frame: they are not free to be written
///   30 hang                          xrWaitFrame of this frame does not come back before a line "answer" is read
///   keep-takes 2                     seconds that pass before the files of a kept frame are written
///   start-hangs                      xrCreateInstance does not, either
///   30 recentre                      the room has another origin from this frame on, as the program is told
///
/// Frames are counted by xrWaitFrame, from 1. Lines may be appended while it runs, with frames as "+3": the third after the one
/// in which they are read.
class Script {
 public:
  /// False, with a message on standard error, for a file that cannot be read or understood.
  [[nodiscard]] bool read(const std::string& path);
  /// What was appended to the file since.
  void readOn(long frame);

  /// Of "head", "left", "right"; false where the thing is not tracked.
  [[nodiscard]] bool place(const std::string& of, long frame, Place& at) const;
  /// Of "right trigger" and so on; 0 before the first line.
  [[nodiscard]] double value(const std::string& of, long frame) const;
  /// Words of this frame: "keep", "hide" and so on.
  [[nodiscard]] std::vector<std::string> events(long frame) const;
  [[nodiscard]] bool has(const std::string& event, long frame) const;
  /// Whether the call that waits for this frame does not come back yet; 0: that which makes the instance.
  [[nodiscard]] bool hangs(long frame) const;

  int width = 320, height = 360;
  double rate_hz = 90.0;
  double keep_takes_s = 0.0;

 private:
  [[nodiscard]] bool understand(const std::string& line, long frame_now);

  std::string path_;
  std::ifstream file_;
  int number_ = 0;  // of the line read last
  bool start_hangs_ = false;
  long answered_ = -1;  // the last frame that hangs no more
  std::map<std::string, std::map<long, Place>> places_;
  std::map<std::string, std::map<long, double>> values_;
  std::multimap<long, std::string> events_;
};

}  // namespace fettle::tests::xr
