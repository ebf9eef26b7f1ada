// SPDX-License-Identifier: Apache-2.0
#include "app/figure/raster.hpp"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <cmath>
#include <memory>

#include "app/output/result_file.hpp"

namespace sunder::app {
namespace {

template <auto release>
struct Release {
  template <class T>
  void operator()(T* object) const {
    release(object);
  }
};
using Surface = std::unique_ptr<cairo_surface_t, Release<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Release<cairo_destroy>>;

struct ReleaseHandle {
  void operator()(RsvgHandle* handle) const { g_object_unref(handle); }
};

void set_color(cairo_t* pen, Color color) {
  cairo_set_source_rgb(pen, color.r / 255.0, color.g / 255.0, color.b / 255.0);
}

void fill(cairo_t* pen, const PaintedTriangle& triangle) {
  // Neighbours must meet without a seam.
  cairo_set_antialias(pen, CAIRO_ANTIALIAS_NONE);
  set_color(pen, triangle.fill);
  for (const Vec2& p : triangle.corners) cairo_line_to(pen, p.x(), p.y());
  cairo_fill(pen);
}

void stroke_rim(cairo_t* pen, const PaintedTriangle& triangle) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!triangle.rim[i]) continue;
    const Vec2 &from = triangle.corners[i], &to = triangle.corners[(i + 1) % 3];
    cairo_set_antialias(pen, CAIRO_ANTIALIAS_DEFAULT);
    set_color(pen, kRimColor);
    cairo_move_to(pen, from.x(), from.y());
    cairo_line_to(pen, to.x(), to.y());
    cairo_stroke(pen);
  }
}

Surface image(double width, double height) {
  return Surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(std::ceil(width)),
                                            static_cast<int>(std::ceil(height))));
}

cairo_status_t append(void* closure, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(closure)->append(bytes, bytes + count);
  return CAIRO_STATUS_SUCCESS;
}

std::string png(cairo_surface_t* surface) {
  std::string bytes;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface, append, &bytes);
  if (status != CAIRO_STATUS_SUCCESS)
    throw OutputError(std::string("cannot make a PNG image: ") + cairo_status_to_string(status));
  return bytes;
}

[[noreturn]] void fail_with(GError* error) {
  const std::string message = error ? error->message : "unknown cause";
  if (error) g_error_free(error);
  throw OutputError("cannot draw a figure: " + message);
}

}  // namespace

std::string png_of_svg(std::string_view svg, double zoom) {
  GError* error = nullptr;
  const std::unique_ptr<RsvgHandle, ReleaseHandle> handle(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error));
  if (!handle) fail_with(error);
  double width = 0, height = 0;
  if (!rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width, &height)) fail_with(nullptr);
  const RsvgRectangle page{0, 0, width * zoom, height * zoom};
  const Surface surface = image(page.width, page.height);
  const Context context(cairo_create(surface.get()));
  if (!rsvg_handle_render_document(handle.get(), context.get(), &page, &error)) fail_with(error);
  return png(surface.get());
}

std::string png_of_triangles(const std::vector<PaintedTriangle>& triangles, const Vec2& corner,
                             const Vec2& size, double zoom, double rim_width) {
  const Surface surface = image(size.x() * zoom, size.y() * zoom);
  const Context context(cairo_create(surface.get()));
  cairo_t* pen = context.get();
  cairo_scale(pen, zoom, zoom);
  cairo_translate(pen, -corner.x(), -corner.y());
  cairo_set_line_width(pen, rim_width);
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
  for (const PaintedTriangle& triangle : triangles) {
    fill(pen, triangle);
    stroke_rim(pen, triangle);
  }
  return png(surface.get());
}

}  // namespace sunder::app
