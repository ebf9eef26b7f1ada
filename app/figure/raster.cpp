// SPDX-License-Identifier: Apache-2.0
#include "app/figure/raster.hpp"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <cmath>
#include <cstring>
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

struct SvgSize {
  double width = 0, height = 0;
};

using Handle = std::unique_ptr<RsvgHandle, ReleaseHandle>;

Handle read_svg(std::string_view svg) {
  GError* error = nullptr;
  Handle handle(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error));
  if (!handle) fail_with(error);
  return handle;
}

SvgSize svg_size_of(RsvgHandle* handle) {
  SvgSize size;
  if (!rsvg_handle_get_intrinsic_size_in_pixels(handle, &size.width, &size.height))
    fail_with(nullptr);
  return size;
}

void draw_svg(RsvgHandle* handle, cairo_surface_t* surface, const SvgSize& size) {
  GError* error = nullptr;
  const RsvgRectangle page{0, 0, size.width, size.height};
  const Context context(cairo_create(surface));
  if (!rsvg_handle_render_document(handle, context.get(), &page, &error)) fail_with(error);
}

}  // namespace

bool draws_pixels() noexcept { return true; }

std::string png_of_svg(std::string_view svg, double zoom) {
  const Handle handle = read_svg(svg);
  const SvgSize size = svg_size_of(handle.get());
  const SvgSize page{size.width * zoom, size.height * zoom};
  const Surface surface = image(page.width, page.height);
  draw_svg(handle.get(), surface.get(), page);
  return png(surface.get());
}

std::string png_of_pixels(const Pixels& pixels, std::string_view svg_over) {
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, pixels.width, pixels.height));
  cairo_surface_flush(surface.get());
  unsigned char* const to = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  const auto width = static_cast<std::size_t>(pixels.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(pixels.height); ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint8_t* from = &pixels.rgba[4 * (y * width + x)];
      const std::uint32_t value = static_cast<std::uint32_t>(from[0]) << 16U |
                                  static_cast<std::uint32_t>(from[1]) << 8U | from[2];
      std::memcpy(to + y * stride + 4 * x, &value, sizeof value);
    }
  }
  cairo_surface_mark_dirty(surface.get());
  if (!svg_over.empty()) {
    const Handle handle = read_svg(svg_over);
    draw_svg(handle.get(), surface.get(),
             {static_cast<double>(pixels.width), static_cast<double>(pixels.height)});
  }
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
