#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/files/folder_listing.h"
#include "app/work/background.h"

namespace fettle::app {

/// The folder that a dialog shows, and the entry chosen in it. A folder is listed in the background: a slow disk or a
/// hundred thousand files hold nobody up. Threading: main.
class FileBrowser {
 public:
  /// Goes to a folder. `chosen`: the name to choose in it, if it is there; `typed`: what its names are to contain, in place of
  /// what was typed in another folder.
  void goTo(const std::string& folder, std::string chosen = {}, std::string typed = {});
  /// The same for a dialog that appears: what was typed in one before it does not count.
  void begin(const std::string& folder, std::string chosen, FilesOf files = FilesOf::kScans);
  /// To the folder that holds this one, which is then the chosen entry.
  void goUp();
  /// Lists the folder again.
  void refresh() { goTo(listing_.folder, chosenName()); }
  /// True when there is something new to show.
  bool poll();

  /// The folder on the screen: the one before while another one is being listed.
  [[nodiscard]] const std::string& folder() const noexcept { return listing_.folder; }
  [[nodiscard]] bool busy() const noexcept { return job_.busy(); }
  /// Why the newest folder could not be listed; null: it could.
  [[nodiscard]] const engine::Error* problem() const noexcept { return problem_ ? &*problem_ : nullptr; }
  [[nodiscard]] std::size_t count() const noexcept { return shown_.size(); }
  /// `i` < count().
  [[nodiscard]] const FolderEntry& entry(std::size_t i) const { return listing_.entries[shown_[i]]; }
  /// Its path; `i` < count().
  [[nodiscard]] std::string pathOf(std::size_t i) const;

  [[nodiscard]] const FolderView& view() const noexcept { return view_; }
  /// The chosen entry stays chosen where it is still shown.
  void setView(FolderView view);
  /// Shows the names that contain `typed`, and chooses the one that is it.
  void narrow(const std::string& typed);
  /// What the beginning of a name becomes by all shown names that begin so: as long as they agree, with a "/" after the only
  /// one if it is a folder. `begun` itself where none does.
  [[nodiscard]] std::string completion(const std::string& begun) const;

  [[nodiscard]] std::optional<std::size_t> chosen() const noexcept { return chosen_; }
  /// `i` < count().
  void choose(std::size_t i) { chosen_ = i; }
  /// Moves the choice by so many entries, no farther than to the first or last; the first is chosen where none was.
  void move(std::ptrdiff_t by);
  void chooseNone() { chosen_.reset(); }

 private:
  [[nodiscard]] std::string chosenName() const { return chosen_ ? entry(*chosen_).name : std::string(); }
  void update(const std::string& chosen);

  FolderListing listing_;
  FolderView view_;
  std::vector<std::size_t> shown_;
  std::optional<std::size_t> chosen_;
  std::string choose_next_;  // in the folder that is being listed
  std::string typed_next_;   // there, if it is another one
  std::optional<engine::Error> problem_;
  Background<FolderListing> job_;
};

}  // namespace fettle::app
