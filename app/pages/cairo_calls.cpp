#include "app/pages/cairo_calls.h"

#include "engine/base/loaded_library.h"

namespace fettle::app {

namespace {

constexpr auto kNoPages = "a PDF cannot be drawn";
constexpr auto kInstead = ", or write .html";

engine::Result<CairoCalls> loaded() {
  CairoCalls calls;
  engine::LoadedLibrary cairo("libcairo.so.2", "libcairo2");
  cairo.find("cairo_create", calls.create);
  cairo.find("cairo_destroy", calls.destroy);
  cairo.find("cairo_fill", calls.fill);
  cairo.find("cairo_font_face_destroy", calls.font_face_destroy);
  cairo.find("cairo_font_face_set_user_data", calls.font_face_set_user_data);
  cairo.find("cairo_font_options_create", calls.font_options_create);
  cairo.find("cairo_font_options_destroy", calls.font_options_destroy);
  cairo.find("cairo_font_options_set_hint_metrics", calls.font_options_set_hint_metrics);
  cairo.find("cairo_font_options_set_hint_style", calls.font_options_set_hint_style);
  cairo.find("cairo_ft_font_face_create_for_ft_face", calls.ft_font_face_create_for_ft_face);
  cairo.find("cairo_image_surface_create_from_png_stream", calls.image_surface_create_from_png_stream);
  cairo.find("cairo_image_surface_get_height", calls.image_surface_get_height);
  cairo.find("cairo_image_surface_get_width", calls.image_surface_get_width);
  cairo.find("cairo_matrix_init_identity", calls.matrix_init_identity);
  cairo.find("cairo_matrix_init_scale", calls.matrix_init_scale);
  cairo.find("cairo_move_to", calls.move_to);
  cairo.find("cairo_paint", calls.paint);
  cairo.find("cairo_pdf_surface_add_outline", calls.pdf_surface_add_outline);
  cairo.find("cairo_pdf_surface_create_for_stream", calls.pdf_surface_create_for_stream);
  cairo.find("cairo_pdf_surface_set_metadata", calls.pdf_surface_set_metadata);
  cairo.find("cairo_rectangle", calls.rectangle);
  cairo.find("cairo_restore", calls.restore);
  cairo.find("cairo_save", calls.save);
  cairo.find("cairo_scale", calls.scale);
  cairo.find("cairo_scaled_font_create", calls.scaled_font_create);
  cairo.find("cairo_scaled_font_destroy", calls.scaled_font_destroy);
  cairo.find("cairo_scaled_font_status", calls.scaled_font_status);
  cairo.find("cairo_scaled_font_text_extents", calls.scaled_font_text_extents);
  cairo.find("cairo_set_font_face", calls.set_font_face);
  cairo.find("cairo_set_font_size", calls.set_font_size);
  cairo.find("cairo_set_source_rgb", calls.set_source_rgb);
  cairo.find("cairo_set_source_surface", calls.set_source_surface);
  cairo.find("cairo_show_page", calls.show_page);
  cairo.find("cairo_show_text", calls.show_text);
  cairo.find("cairo_status", calls.status);
  cairo.find("cairo_status_to_string", calls.status_to_string);
  cairo.find("cairo_surface_destroy", calls.surface_destroy);
  cairo.find("cairo_surface_finish", calls.surface_finish);
  cairo.find("cairo_surface_status", calls.surface_status);
  cairo.find("cairo_translate", calls.translate);
  if (auto status = cairo.status(kNoPages, "PDF", kInstead); !status) return tl::unexpected(status.error());
  engine::LoadedLibrary rsvg("librsvg-2.so.2", "librsvg2-2");
  rsvg.find("rsvg_handle_new_from_data", calls.rsvg_handle_new_from_data);
  rsvg.find("rsvg_handle_render_document", calls.rsvg_handle_render_document);
  rsvg.find("g_object_unref", calls.g_object_unref);
  rsvg.find("g_error_free", calls.g_error_free);
  if (auto status = rsvg.status(kNoPages, "PDF", kInstead); !status) return tl::unexpected(status.error());
  return calls;
}

}  // namespace

engine::Result<const CairoCalls*> cairoCalls() {
  static const engine::Result<CairoCalls> calls = loaded();
  if (!calls) return tl::unexpected(calls.error());
  return &*calls;
}

}  // namespace fettle::app
