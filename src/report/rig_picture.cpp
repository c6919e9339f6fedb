// The picture of a rig with the elements that a diagnosis holds guilty marked, as SVG.
#include <report/rig_picture.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <report/html_page.hpp>

#include "diagnosis/result_text.hpp"

namespace pneuservo {
namespace {

constexpr double tinted_from = 0.01, figured_from = 0.05;

/// Where a share is written.
struct Place {
  double x = 0, y = 0;
};

/// Collects groups; figures of shares lie above all of them.
class Picture {
 public:
  Picture(const std::vector<PictureMark>& marks, std::vector<std::string> sensors)
      : marks_(marks), sensors_(std::move(sensors)) {}

  /// What belongs to no element: rods, guides, words.
  void add(const std::string& shapes) { body_ += shapes; }

  void element(const std::string& name, const std::string& title, const std::string& shapes, Place figure) {
    const double share = share_of(name);
    if (share < tinted_from) {
      body_ += fmt::format("<g data-element=\"{}\"><title>{}</title>{}</g>\n", name, html_escape(title), shapes);
      return;
    }
    const std::string percent = fmt::format("{:.0f}", 100 * share);
    body_ += fmt::format("<g data-element=\"{}\" data-share=\"{}\" class=\"guilty\" style=\"--share:{:.2f}\">"
                         "<title>{}: {} %</title>{}</g>\n",
                         name, percent, share, html_escape(title), percent, shapes);
    if (share < figured_from) return;
    const double width = percent.size() > 2 ? 58 : 48;
    figures_ +=
        fmt::format("<g class=\"share\"><rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"24\" rx=\"12\"/>"
                    "<text x=\"{:.0f}\" y=\"{:.0f}\">{} %</text></g>\n",
                    figure.x - width / 2, figure.y - 12, width, figure.x, figure.y + 5, percent);
  }

  /// A gauge at the end of a short stub from (x, y); drawn only where the recordings have the channel.
  void sensor(Signal signal, const std::string& title, Place at, Place gauge, const std::string& letter) {
    const std::string channel(info(signal).name);
    if (std::find(sensors_.begin(), sensors_.end(), channel) == sensors_.end()) return;
    element("sensor:" + channel, "sensor of " + title,
            fmt::format("<path d=\"M{:.0f} {:.0f}L{:.0f} {:.0f}\" class=\"thin\"/><circle cx=\"{:.0f}\" cy=\"{:.0f}\" "
                        "r=\"13\"/><text x=\"{:.0f}\" y=\"{:.0f}\">{}</text>",
                        at.x, at.y, gauge.x, gauge.y, gauge.x, gauge.y, gauge.x, gauge.y + 5, letter),
            {gauge.x, gauge.y + (gauge.y < at.y ? -28 : 28)});
  }

  /// What lies in the given rectangle.
  std::string svg(double x, double y, double width, double height, const std::string& label) const {
    return fmt::format("<svg class=\"rig\" viewBox=\"{:.0f} {:.0f} {:.0f} {:.0f}\" style=\"max-width:{:.0f}px\" "
                       "role=\"img\" aria-label=\"{}\">{}{}</svg>",
                       x, y, width, height, width, html_escape(label), body_, figures_);
  }

 private:
  double share_of(const std::string& name) const {
    double share = 0;
    for (const PictureMark& mark : marks_)
      if (mark.element == name) share += mark.share;
    return share;
  }

  const std::vector<PictureMark>& marks_;
  std::vector<std::string> sensors_;
  std::string body_, figures_;
};

std::string text(double x, double y, std::string_view words, const char* kind = "") {
  return fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" class=\"{}\">{}</text>", x, y, kind, html_escape(words));
}

std::string box(double x, double y, double width, double height) {
  return fmt::format("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\"/>", x, y, width, height);
}

std::string line_words(int side, const LineParameters<double>& line) {
  return fmt::format("line {}: {:g} m \u00d7 {:g} mm", side, line.length_m, 1e3 * line.diameter_m);
}

/// A pipe from the valve along y, with turns of a coil in its middle, to the chamber's port at end_y.
std::string pipe(double from_y, double y, double end_x, double end_y) {
  std::string path = fmt::format("M250 {:.0f}V{:.0f}H340", from_y, y);
  for (int turn = 0; turn < 5; ++turn) path += " c34 0 34 -30 14 -30 s-20 30 14 30";
  return fmt::format("<path class=\"pipe\" d=\"{}H{:.0f}V{:.0f}\"/>", path, end_x, end_y);
}

/// Two positions of the spool side by side, supply below and exhaust beside it.
std::string valve_shapes() {
  return box(190, 180, 60, 60) + box(250, 180, 60, 60) +
         "<path class=\"thin\" d=\"M205 236L235 186M235 186l-2 11M235 186l-10 6M235 236L205 186M205 186l2 11M205 "
         "186l10 "
         "6M265 236V186M265 186l-5 9M265 186l5 9M295 186V236M295 236l-5 -9M295 236l5 -9\"/>";
}

/// Two three-port valves, one a side.
std::string valve_pair_shapes() {
  return box(190, 166, 120, 36) + text(250, 189, "valve 1", "small") + box(190, 218, 120, 36) +
         text(250, 241, "valve 2", "small");
}

void draw_slider(Picture& picture, const Rig& rig, double rod_from) {
  const double mass = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
  picture.add(
      "<path class=\"thin\" d=\"M868 262H1064M878 262l-8 10M908 262l-8 10M938 262l-8 10M968 262l-8 10M998 262l-8 "
      "10M1028 262l-8 10M1058 262l-8 10\"/>");
  picture.element("motion", element_words("motion"),
                  box(rod_from, 202, 900 - rod_from, 16) + box(900, 168, 110, 94) + text(955, 206, "slider") +
                      text(955, 226, fmt::format("{:g} kg", mass), "small"),
                  {955, 152});
  picture.sensor(Signal::x, "position", {985, 262}, {985, 300}, "x");
}

std::string pneumatic_picture(const Rig& rig, const std::vector<std::string>& sensors,
                              const std::vector<PictureMark>& marks) {
  const bool has_pair = valve_arrangement(rig) == ValveArrangement::three_port_pair;
  Picture picture(marks, sensors);
  picture.add(box(20, 20, 130, 46) + text(85, 48, "controller"));
  picture.element("timing", "timing of the command",
                  "<path d=\"M150 43H220V176\" class=\"signal\"/><path class=\"tip\" d=\"M220 180l-6 -12h12z\"/>",
                  {220, 92});
  picture.add(text(150, 100, "command", "small"));
  picture.element("supply", "supply",
                  fmt::format("<path class=\"pipe\" d=\"{}\"/><circle cx=\"58\" cy=\"210\" r=\"26\"/>"
                              "<path d=\"M46 196L76 210L46 224Z\"/>",
                              has_pair ? "M82 210H170M190 184H170V236H190" : "M82 210H190") +
                      text(58, 262, "supply", "") +
                      text(58, 280, fmt::format("{:g} kPa", 1e-3 * rig.axis.supply.pressure_Pa), "small"),
                  {58, 168});
  picture.element("line_1", line_words(1, rig.axis.line_1), pipe(180, 100, 610, 160), {480, 62});
  picture.element("line_2", line_words(2, rig.axis.line_2), pipe(240, 340, 770, 260), {480, 302});
  picture.add(text(470, 128, line_words(1, rig.axis.line_1), "small") +
              text(470, 368, line_words(2, rig.axis.line_2), "small"));
  if (has_pair) picture.element("valve", "valves", valve_pair_shapes(), {330, 210});
  else picture.element("valve", "valve", valve_shapes() + text(342, 215, "valve"), {280, 160});
  picture.element("chamber_1", "chamber 1", box(580, 160, 100, 100) + text(630, 215, "chamber 1", "small"), {630, 180});
  picture.element("chamber_2", "chamber 2", box(700, 160, 120, 100) + text(760, 238, "chamber 2", "small"), {760, 180});
  draw_slider(picture, rig, 700);
  picture.element("piston", "piston between the chambers", box(680, 160, 20, 100), {690, 282});
  picture.sensor(Signal::p1_port, "port pressure 1", {250, 140}, {210, 140}, "p");
  picture.sensor(Signal::p2_port, "port pressure 2", {250, 290}, {210, 290}, "p");
  picture.sensor(Signal::p_supply, "supply pressure", {130, 210}, {130, 250}, "p");
  picture.sensor(Signal::p1_chamber, "pressure in chamber 1", {650, 160}, {650, 122}, "p");
  picture.sensor(Signal::p2_chamber, "pressure in chamber 2", {730, 160}, {730, 122}, "p");
  if (rig.has_sensor(Signal::dp1)) {
    picture.sensor(Signal::dp1, "pressure lost along line 1", {400, 100}, {400, 138}, "dp");
    picture.sensor(Signal::dp2, "pressure lost along line 2", {400, 340}, {400, 302}, "dp");
  }
  return picture.svg(0, 0, 1080, 390, "The rig with the share of each element in the mismatch");
}

std::string driven_picture(const Rig& rig, const std::vector<std::string>& sensors,
                           const std::vector<PictureMark>& marks) {
  Picture picture(marks, sensors);
  picture.add(box(420, 60, 130, 46) + text(485, 88, "controller"));
  picture.element("timing", "timing of the command",
                  "<path d=\"M485 106V168\" class=\"signal\"/><path class=\"tip\" d=\"M485 176l-6 -12h12z\"/>",
                  {485, 136});
  picture.element("drive", "drive",
                  box(420, 176, 130, 68) + text(485, 206, "drive") +
                      text(485, 226, fmt::format("\u00b1{:g} N", rig.drive.force_max_N), "small"),
                  {485, 262});
  draw_slider(picture, rig, 550);
  picture.sensor(Signal::F, "drive force", {720, 202}, {720, 166}, "F");
  if (rig.has_pistons()) {
    picture.element(rig.axis.cylinder.area_1_m2 > 0 ? "chamber_1" : "chamber_2", "piston that a pressure pushes",
                    box(640, 186, 40, 48) + text(660, 262, "piston", "small"), {660, 282});
    picture.sensor(Signal::p1_chamber, "pressure in chamber 1", {650, 186}, {650, 150}, "p");
    picture.sensor(Signal::p2_chamber, "pressure in chamber 2", {672, 186}, {690, 130}, "p");
  }
  return picture.svg(400, 45, 680, 285, "The axis with the share of each element in the mismatch");
}

// What stands before an on/off valve.
void draw_switched_supply(Picture& picture) {
  picture.element("timing", "timing of the command",
                  "<path d=\"M150 43H220V176\" class=\"signal\"/><path class=\"tip\" d=\"M220 180l-6 -12h12z\"/>",
                  {220, 92});
  picture.add(text(150, 100, "command", "small"));
  picture.element("supply", "supply",
                  "<path class=\"pipe\" d=\"M82 210H190\"/><circle cx=\"58\" cy=\"210\" r=\"26\"/>" +
                      text(58, 262, "supply"),
                  {58, 168});
}

std::string vessel_picture(const Rig& rig, const std::vector<std::string>& sensors,
                           const std::vector<PictureMark>& marks) {
  Picture picture(marks, sensors);
  draw_switched_supply(picture);
  picture.element("valve", "on/off valve", box(190, 180, 120, 60) + text(250, 215, "valve"), {250, 262});
  const std::string words = rig.line ? line_words(1, *rig.line) : std::string("no line");
  picture.element("line_1", words, "<path class=\"pipe\" d=\"M310 210H560\"/>", {435, 240});
  picture.add(text(435, 190, words, "small"));
  picture.element("chamber_1", "vessel",
                  box(560, 150, 200, 120) + text(660, 206, "vessel") +
                      text(660, 226, fmt::format("{:g} l", 1e3 * rig.vessel.volume_m3), "small"),
                  {660, 132});
  picture.sensor(Signal::p1_port, "pressure at the valve", {330, 210}, {330, 160}, "p");
  picture.sensor(Signal::p1_chamber, "pressure in the vessel", {720, 150}, {720, 112}, "p");
  return picture.svg(0, 30, 800, 270, "The vessel with the share of each element in the mismatch");
}

std::string switched_picture(const Rig& rig, const std::vector<std::string>& sensors,
                             const std::vector<PictureMark>& marks) {
  Picture picture(marks, sensors);
  draw_switched_supply(picture);
  picture.element("valve", "on/off valve", valve_shapes() + text(342, 215, "valve"), {280, 160});
  picture.add("<path class=\"pipe\" d=\"M250 180V100H610V160M250 240V340H790V260\"/>");
  picture.element("throttle_1", "flow control valve of chamber 1",
                  box(400, 80, 90, 40) + text(445, 105, "throttle 1", "small"), {445, 62});
  picture.element("throttle_2", "flow control valve of chamber 2",
                  box(400, 320, 90, 40) + text(445, 345, "throttle 2", "small"), {445, 302});
  picture.element("chamber_1", "chamber 1", box(580, 160, 100, 100) + text(630, 215, "chamber 1", "small"), {630, 180});
  picture.element("chamber_2", "chamber 2", box(700, 160, 120, 100) + text(760, 238, "chamber 2", "small"), {760, 180});
  draw_slider(picture, rig, 700);
  picture.element("piston", "piston between the chambers", box(680, 160, 20, 100), {690, 282});
  picture.element("cushion_1", "cushion at the end of chamber 1", box(580, 160, 14, 100), {580, 145});
  picture.element("cushion_2", "cushion at the end of chamber 2", box(806, 160, 14, 100), {820, 145});
  return picture.svg(0, 0, 1080, 390, "The cylinder with the share of each element in the mismatch");
}

}  // namespace

std::string rig_picture(const Rig& rig, const std::vector<std::string>& sensors,
                        const std::vector<PictureMark>& marks) {
  switch (rig.kind) {
    case RigKind::driven_axis: return driven_picture(rig, sensors, marks);
    case RigKind::vessel: return vessel_picture(rig, sensors, marks);
    case RigKind::switched_cylinder: return switched_picture(rig, sensors, marks);
    default: return pneumatic_picture(rig, sensors, marks);
  }
}

}  // namespace pneuservo
