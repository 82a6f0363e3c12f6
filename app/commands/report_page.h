#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/commands/areal_table.h"

namespace fettle::app {

/// What `fettle report` says of a scan, as texts.
struct ReportPage {
  struct Picture {
    std::string caption, png;
  };
  struct Table {
    std::string title, note;  ///< the note below it may be empty
    std::vector<std::string> heads;
    std::vector<std::vector<std::string>> rows;  ///< as many cells each as there are heads
  };

  std::string title, made_with;
  std::vector<Picture> pictures;
  std::vector<Table> tables;
};

/// One HTML page without other files, made to be printed on A4 as well. The same page for the same texts and pictures.
[[nodiscard]] std::string reportPage(const ReportPage& report);

/// Surface texture, of one or several states side by side; `states` names them.
[[nodiscard]] ReportPage::Table textureTable(const std::vector<ArealLine>& lines,
                                             const std::vector<std::string>& states, std::string note);

}  // namespace fettle::app
