#pragma once

#include <string>
#include <variant>
#include <vector>

#include "app/pages/page_text.h"
#include "app/pages/report_page.h"

namespace fettle::app {

// A report laid out on sheets of A4. Lengths in points of 1/72 inch, x from the left, y down from the top.

inline constexpr double kSheetWidth = 595.276, kSheetHeight = 841.89;
inline constexpr double kSheetMargin = 51.0;  ///< 18 mm
inline constexpr double kSheetTextWidth = kSheetWidth - 2.0 * kSheetMargin;
inline constexpr double kPlotWidth = 860.0, kPlotHeight = 480.0;  ///< of the plots' SVG, of any unit

struct SheetText {
  double x = 0.0, y = 0.0;  ///< where its base line begins
  double size = 0.0, grey = 0.0;
  FaceWeight weight = FaceWeight::kRegular;
  std::string text;
};
/// A filled rectangle: a line of a table, or the ground of its head.
struct SheetBox {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0, grey = 0.0;
};
struct SheetPicture {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  const ReportPage::Picture* picture = nullptr;
};
struct SheetPlot {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  const ReportPage::Plot* plot = nullptr;
};
struct SheetHeading {
  double y = 0.0;
  std::string text;
};
using SheetItem = std::variant<SheetText, SheetBox, SheetPicture, SheetPlot>;
struct Sheet {
  std::vector<SheetItem> items;        ///< drawn in this order
  std::vector<SheetHeading> headings;  ///< for an outline
};

/// Lays a report out: a heading never ends a sheet, a row of a table is on one sheet unless it is longer than a sheet,
/// the head of a table that goes on stands on each. At least one sheet. Points into `report`. Errors (kFailed): a picture
/// whose size cannot be read.
[[nodiscard]] engine::Result<std::vector<Sheet>> sheetsOf(const ReportPage& report, const PageText& text);

}  // namespace fettle::app
