#include "tests/figures/svg.h"

namespace sonoband::figures {

Svg::Svg(const std::string& file, double width_mm, double height_mm, double scale)
    : out_(file), scale_(scale) {
  out_.precision(5);
  out_ << "<svg xmlns='http://www.w3.org/2000/svg' width='" << width_mm * scale << "' height='"
       << height_mm * scale << "'>\n<rect width='100%' height='100%' fill='white'/>\n";
}

Svg::~Svg() {
  out_ << "</svg>\n";
}

void Svg::line(const PlaneLine& points, const Pen& pen) {
  out_ << "<polyline fill='none' stroke='" << pen.colour << "' stroke-width='" << pen.width << "'";
  if (!pen.dashes.empty()) out_ << " stroke-dasharray='" << pen.dashes << "'";
  out_ << " points='";
  for (const PlanePoint& p : points) out_ << p.x() * scale_ << ',' << p.y() * scale_ << ' ';
  out_ << "'/>\n";
}

void Svg::dot(const PlanePoint& at, double radius_px, const std::string& colour) {
  out_ << "<circle cx='" << at.x() * scale_ << "' cy='" << at.y() * scale_ << "' r='" << radius_px
       << "' fill='" << colour << "'/>\n";
}

void Svg::text(const PlanePoint& at, const std::string& words) {
  out_ << "<text x='" << at.x() * scale_ << "' y='" << at.y() * scale_
       << "' font-family='sans-serif' font-size='13'>" << words << "</text>\n";
}

}  // namespace sonoband::figures
