// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/study.hpp"

#include "app/output/text.hpp"

namespace sunder::app::reproduce {

std::string cell(double value) { return number(value); }

std::string cell(const std::optional<double>& value) { return value ? number(*value) : ""; }

Drawing chart_drawing(const std::string& name, const std::string& caption,
                      const std::vector<ChartSeries>& series, const ChartAxes& axes) {
  return {name, caption, line_chart(series, axes), true};
}

}  // namespace sunder::app::reproduce
