#pragma once

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <librsvg/rsvg.h>

#include "engine/base/error.h"

namespace fettle::app {

/// The functions of cairo and librsvg that pages are drawn with, by their own names without the prefix. The libraries are loaded when a page is
/// first made, not with the program: with theirs they are 24, a quarter of the instructions that the program starts in.
struct CairoCalls {
  decltype(&cairo_create) create = nullptr;
  decltype(&cairo_destroy) destroy = nullptr;
  decltype(&cairo_fill) fill = nullptr;
  decltype(&cairo_font_face_destroy) font_face_destroy = nullptr;
  decltype(&cairo_font_face_set_user_data) font_face_set_user_data = nullptr;
  decltype(&cairo_font_options_create) font_options_create = nullptr;
  decltype(&cairo_font_options_destroy) font_options_destroy = nullptr;
  decltype(&cairo_font_options_set_hint_metrics) font_options_set_hint_metrics = nullptr;
  decltype(&cairo_font_options_set_hint_style) font_options_set_hint_style = nullptr;
  decltype(&cairo_ft_font_face_create_for_ft_face) ft_font_face_create_for_ft_face = nullptr;
  decltype(&cairo_image_surface_create_from_png_stream) image_surface_create_from_png_stream = nullptr;
  decltype(&cairo_image_surface_get_height) image_surface_get_height = nullptr;
  decltype(&cairo_image_surface_get_width) image_surface_get_width = nullptr;
  decltype(&cairo_matrix_init_identity) matrix_init_identity = nullptr;
  decltype(&cairo_matrix_init_scale) matrix_init_scale = nullptr;
  decltype(&cairo_move_to) move_to = nullptr;
  decltype(&cairo_paint) paint = nullptr;
  decltype(&cairo_pdf_surface_add_outline) pdf_surface_add_outline = nullptr;
  decltype(&cairo_pdf_surface_create_for_stream) pdf_surface_create_for_stream = nullptr;
  decltype(&cairo_pdf_surface_set_metadata) pdf_surface_set_metadata = nullptr;
  decltype(&cairo_rectangle) rectangle = nullptr;
  decltype(&cairo_restore) restore = nullptr;
  decltype(&cairo_save) save = nullptr;
  decltype(&cairo_scale) scale = nullptr;
  decltype(&cairo_scaled_font_create) scaled_font_create = nullptr;
  decltype(&cairo_scaled_font_destroy) scaled_font_destroy = nullptr;
  decltype(&cairo_scaled_font_status) scaled_font_status = nullptr;
  decltype(&cairo_scaled_font_text_extents) scaled_font_text_extents = nullptr;
  decltype(&cairo_set_font_face) set_font_face = nullptr;
  decltype(&cairo_set_font_size) set_font_size = nullptr;
  decltype(&cairo_set_source_rgb) set_source_rgb = nullptr;
  decltype(&cairo_set_source_surface) set_source_surface = nullptr;
  decltype(&cairo_show_page) show_page = nullptr;
  decltype(&cairo_show_text) show_text = nullptr;
  decltype(&cairo_status) status = nullptr;
  decltype(&cairo_status_to_string) status_to_string = nullptr;
  decltype(&cairo_surface_destroy) surface_destroy = nullptr;
  decltype(&cairo_surface_finish) surface_finish = nullptr;
  decltype(&cairo_surface_status) surface_status = nullptr;
  decltype(&cairo_translate) translate = nullptr;
  decltype(&::rsvg_handle_new_from_data) rsvg_handle_new_from_data = nullptr;
  decltype(&::rsvg_handle_render_document) rsvg_handle_render_document = nullptr;
  decltype(&::g_object_unref) g_object_unref = nullptr;
  decltype(&::g_error_free) g_error_free = nullptr;
};

/// They, loaded by the first call; the same object ever after. Errors (kFailed): a library that is not installed, with the package that has it.
/// Thread: any.
[[nodiscard]] engine::Result<const CairoCalls*> cairoCalls();

}  // namespace fettle::app
