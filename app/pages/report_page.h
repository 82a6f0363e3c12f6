#pragma once

#include <string>
#include <variant>
#include <vector>

#include "engine/base/error.h"

namespace fettle::app {

/// What `fettle report` says of a scan, as texts and pictures in reading order: the one content of all forms in which it
/// is written.
struct ReportPage {
  struct Heading {
    std::string text;
  };
  struct Paragraph {
    std::string text;
  };
  struct Picture {
    std::string caption, png;
  };
  struct Plot {
    std::string caption, svg;  ///< an SVG element of gnuplot, kPlotWidth x kPlotHeight
  };
  struct Table {
    std::string title, note;  ///< the note below it may be empty
    std::vector<std::string> heads;
    std::vector<std::vector<std::string>> rows;  ///< as many cells each as there are heads
  };
  using Part = std::variant<Heading, Paragraph, Picture, Plot, Table>;

  std::string title, made_with;
  std::vector<Part> parts;
};

/// Whether a cell is a figure: these stand to the right, so that their digits can be compared.
[[nodiscard]] bool isFigure(const std::string& cell) noexcept;
/// Whether the cells of a column, and so its head, stand to the right: one of them is a figure.
[[nodiscard]] bool hasFigures(const ReportPage::Table& table, std::size_t column) noexcept;

/// One HTML page without other files, made to be printed on A4 as well. The same bytes for the same content.
[[nodiscard]] std::string reportHtml(const ReportPage& report);

/// The same as a PDF of A4 pages, numbered, with the headings as its outline: text that can be selected, in the program's own
/// font, which is embedded; plots as lines and text, pictures sample by sample. It has no date, so that the same content gives the same bytes
/// with the same libraries; the texts within plots are in the font that this machine has by the plot's name. Characters that the
/// font lacks are drawn as a box and copied as they are; scripts that join their letters are not joined.
///
/// Errors (kFailed): a picture or plot that cannot be read, no memory; a library that is not installed (cairo_calls.h). Thread: any.
[[nodiscard]] engine::Result<std::string> reportPdf(const ReportPage& report);

/// Whether the libraries that a PDF is drawn with are installed, to be asked before the work for one. Errors (kFailed): which is
/// missing, and the package that has it.
[[nodiscard]] engine::Status pdfIsPossible();

}  // namespace fettle::app
