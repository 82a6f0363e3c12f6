#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "app/pages/cairo_calls.h"
#include "app/pages/page_text.h"
#include "app/pages/report_page.h"
#include "app/pages/report_sheets.h"

namespace fettle::app {

namespace {

struct Freed {
  const CairoCalls* cairo;

  void operator()(cairo_surface_t* surface) const { cairo->surface_destroy(surface); }
  void operator()(cairo_t* page) const { cairo->destroy(page); }
  void operator()(RsvgHandle* drawing) const { cairo->g_object_unref(drawing); }
  void operator()(GError* error) const { cairo->g_error_free(error); }
};
template <class T>
using Owned = std::unique_ptr<T, Freed>;

engine::Status madeBy(const CairoCalls& cairo, cairo_status_t status, const std::string& where) {
  if (status == CAIRO_STATUS_SUCCESS) return {};
  return engine::failure(cairo.status_to_string(status), where, "please report this");
}

struct PngBytes {
  const std::string* png;
  std::size_t at = 0;
};
cairo_status_t readPng(void* from, unsigned char* data, unsigned int length) {
  auto& bytes = *static_cast<PngBytes*>(from);
  if (bytes.png->size() - bytes.at < length) return CAIRO_STATUS_READ_ERROR;
  std::memcpy(data, bytes.png->data() + bytes.at, length);
  bytes.at += length;
  return CAIRO_STATUS_SUCCESS;
}

cairo_status_t appendTo(void* to, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

// Draws what a sheet has.
struct SheetDrawing {
  const CairoCalls& cairo;
  cairo_t* page;
  const PageText& text;

  engine::Status operator()(const SheetText& item) const {
    cairo.set_source_rgb(page, item.grey, item.grey, item.grey);
    text.draw(page, item.text, item.x, item.y, item.size, item.weight);
    return madeBy(cairo, cairo.status(page), item.text);
  }
  engine::Status operator()(const SheetBox& item) const {
    cairo.set_source_rgb(page, item.grey, item.grey, item.grey);
    cairo.rectangle(page, item.x, item.y, item.width, item.height);
    cairo.fill(page);
    return {};
  }
  engine::Status operator()(const SheetPicture& item) const {
    PngBytes bytes{&item.picture->png};
    const Owned<cairo_surface_t> picture(cairo.image_surface_create_from_png_stream(readPng, &bytes),
                                         Freed{&cairo});
    if (auto status = madeBy(cairo, cairo.surface_status(picture.get()), item.picture->caption); !status)
      return status;
    cairo.save(page);
    cairo.translate(page, item.x, item.y);
    cairo.scale(page, item.width / cairo.image_surface_get_width(picture.get()),
                item.height / cairo.image_surface_get_height(picture.get()));
    cairo.set_source_surface(page, picture.get(), 0.0, 0.0);
    cairo.paint(page);
    cairo.restore(page);
    return madeBy(cairo, cairo.status(page), item.picture->caption);
  }
  engine::Status operator()(const SheetPlot& item) const {
    GError* said = nullptr;
    const std::string& svg = item.plot->svg;
    const Owned<RsvgHandle> drawing(
        cairo.rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &said),
        Freed{&cairo});
    const RsvgRectangle place{item.x, item.y, item.width, item.height};
    const bool drawn =
        drawing != nullptr && cairo.rsvg_handle_render_document(drawing.get(), page, &place, &said) != 0;
    const Owned<GError> error(said, Freed{&cairo});
    if (!drawn)
      return engine::failure(error != nullptr ? error->message : "a plot cannot be drawn", item.plot->caption,
                             "please report this");
    return madeBy(cairo, cairo.status(page), item.plot->caption);
  }
};

}  // namespace

engine::Status pdfIsPossible() {
  const auto loaded = cairoCalls();
  return loaded ? engine::Status() : tl::unexpected(loaded.error());
}

engine::Result<std::string> reportPdf(const ReportPage& report) {
  const auto loaded = cairoCalls();
  if (!loaded) return tl::unexpected(loaded.error());
  const CairoCalls& cairo = **loaded;
  const auto text = PageText::create();
  if (!text) return tl::unexpected(text.error());
  const auto sheets = sheetsOf(report, *text);
  if (!sheets) return tl::unexpected(sheets.error());
  std::string bytes;
  const Owned<cairo_surface_t> file(
      cairo.pdf_surface_create_for_stream(appendTo, &bytes, kSheetWidth, kSheetHeight), Freed{&cairo});
  // What cairo writes by itself is the present date, unless it is taken out.
  cairo.pdf_surface_set_metadata(file.get(), CAIRO_PDF_METADATA_CREATE_DATE, nullptr);
  cairo.pdf_surface_set_metadata(file.get(), CAIRO_PDF_METADATA_MOD_DATE, nullptr);
  const std::string title = text->linesOf(report.title, 1.0, FaceWeight::kBold, 1e9).front();
  cairo.pdf_surface_set_metadata(file.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
  const Owned<cairo_t> page(cairo.create(file.get()), Freed{&cairo});
  int number = 0;
  for (const Sheet& sheet : *sheets) {
    ++number;
    for (const SheetHeading& heading : sheet.headings)
      cairo.pdf_surface_add_outline(file.get(), CAIRO_PDF_OUTLINE_ROOT,
                                    text->linesOf(heading.text, 1.0, FaceWeight::kBold, 1e9).front().c_str(),
                                    fmt::format("page={} pos=[0 {:.3f}]", number, heading.y).c_str(),
                                    CAIRO_PDF_OUTLINE_FLAG_OPEN);
    const SheetDrawing drawing{cairo, page.get(), *text};
    for (const SheetItem& item : sheet.items)
      if (auto status = std::visit(drawing, item); !status) return tl::unexpected(status.error());
    cairo.show_page(page.get());
  }
  if (auto status = madeBy(cairo, cairo.status(page.get()), "the PDF"); !status)
    return tl::unexpected(status.error());
  cairo.surface_finish(file.get());
  if (auto status = madeBy(cairo, cairo.surface_status(file.get()), "the PDF"); !status)
    return tl::unexpected(status.error());
  return bytes;
}

}  // namespace fettle::app
