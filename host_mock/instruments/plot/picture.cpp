// SPDX-License-Identifier: BSD-3-Clause
#include "plot/picture.hpp"

#include "plot/envelope.hpp"
#include "plot/gnuplot.hpp"
#include "plot/history_file.hpp"
#include "plot/status_panel.hpp"

#include <ilaw/ilaw.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

namespace ilaw::host {
namespace {

// A column of history.csv: "n3.floor.gap" is the gap of node n3, owner "n3 floor", and "n3.u1"
// component 1 of u.
struct Curve {
  std::size_t column;  // from 1, as gnuplot counts
  std::string node, owner, component;
};

struct Panel {
  std::string quantity, label;
  std::vector<Curve> curves;
  bool summed = false;  // over time
};

// Sizes in pixels. A letter: of the key and of tics, of the title.
constexpr double panel_width = 785, least_left = 95, least_right = 120, title_line = 22, below = 55,
                 between = 18, curve_height = 120, row_height = 24, key_line = 18, key_letter = 8.0,
                 title_letter = 9.5;
constexpr std::size_t longest_label = 15;  // letters of a panel's name in a line

bool is_component(std::string_view name) {
  return name.size() == 2 && std::string_view("uvr").find(name[0]) != std::string_view::npos &&
         std::isdigit(static_cast<unsigned char>(name[1]));
}

bool is_node(std::string_view name) {
  return name.size() > 1 && name[0] == 'n' && std::isdigit(static_cast<unsigned char>(name[1]));
}

// A component of a force or a moment, "floor.F2".
bool is_resultant(std::string_view owner, std::string_view name) {
  return !is_node(owner) && name.size() == 2 && (name[0] == 'F' || name[0] == 'M') &&
         std::isdigit(static_cast<unsigned char>(name[1]));
}

Panel& panel_of(const std::string& quantity, std::vector<Panel>& panels) {
  const auto found = std::find_if(panels.begin(), panels.end(),
                                  [&](const Panel& panel) { return panel.quantity == quantity; });
  return found != panels.end() ? *found : panels.emplace_back(Panel{quantity, quantity, {}});
}

// The balance of the whole: energies in one panel, what laws dissipate in another, what must be
// small or constant in panels of its own.
constexpr std::string_view balance = "balance.";
void add_balance(const std::string& name, std::size_t column, std::vector<Panel>& panels) {
  const std::string quantity = name.substr(balance.size());
  constexpr std::string_view dissipated = "dissipated_";
  const bool is_loss = quantity.starts_with(dissipated);
  const std::string label = is_loss                                    ? "dissipated"
                            : quantity == "error"                      ? "balance error"
                            : quantity.starts_with("angular_momentum") ? "angular momentum"
                                                                       : "energy";
  const std::string legend = is_loss                       ? quantity.substr(dissipated.size())
                             : label == "angular momentum" ? "axis " + quantity.substr(quantity.size() - 1)
                                                           : quantity.substr(0, quantity.find("_work"));
  panel_of(label, panels).curves.push_back({column, legend, legend, ""});
}

// The balance of heat: its parts in one panel, its error in another.
constexpr std::string_view heat_prefix = "heat.";
void add_heat(const std::string& name, std::size_t column, std::vector<Panel>& panels) {
  const std::string part = name.substr(heat_prefix.size());
  panel_of(part == "error" ? "heat balance error" : "heat", panels)
      .curves.push_back({column, part, part, ""});
}

bool is_motion(const Panel& panel) {
  return panel.quantity == "gap" || panel.quantity == "u" || panel.quantity == "v";
}

// The panels from top to bottom; those that stay empty go.
std::vector<Panel> panels_of(const Columns& columns, int every) {
  const std::vector<std::string>& header = columns.names;
  std::vector<Panel> panels = {
      {"gap", "gap", {}}, {"u", "displacement", {}}, {"v", "velocity", {}}, {"r", "impulse", {}}};
  Panel status{"status", "status", {}};
  for (std::size_t i = 1; i < header.size(); ++i) {
    const std::string owner = header[i].substr(0, header[i].rfind('.'));
    std::string name = header[i].substr(owner.size() + 1), component;
    if (is_resultant(owner, name)) {
      const char* label = name[0] == 'F' ? "force" : "moment";
      panel_of(label, panels).curves.push_back({i + 1, owner, owner, name});
      continue;
    }
    if (header[i].starts_with(balance)) {
      if (!columns.all_zero[i]) add_balance(header[i], i + 1, panels);
      continue;
    }
    if (header[i].starts_with(heat_prefix)) {
      if (!columns.all_zero[i]) add_heat(header[i], i + 1, panels);
      continue;
    }
    if (is_node(owner) && name == "T") name = "temperature";
    if (is_component(name)) {
      component = name;
      name.resize(1);
    }
    Panel& panel = name == "status" ? status : panel_of(name, panels);
    panel.curves.push_back({i + 1, owner.substr(0, owner.find('.')), owner, component});
  }
  // A force is hardly seen beside a shock, but its sum is. A sum needs every step.
  if (every == 1) panels.insert(panels.begin() + 4, {"r", "summed impulse", panels[3].curves, true});
  // States that the scene does not use stay zero, and impulses of nodes that meet nothing.
  const auto is_zero = [&](const Curve& curve) { return columns.all_zero[curve.column - 1]; };
  std::erase_if(panels, [&](const Panel& panel) {
    return !is_motion(panel) && std::all_of(panel.curves.begin(), panel.curves.end(), is_zero);
  });
  panels.push_back(status);
  std::erase_if(panels, [](const Panel& panel) { return panel.curves.empty(); });
  return panels;
}

// The panels of these names, in their order; all where there are none.
std::vector<Panel> chosen(std::vector<Panel> panels, const std::vector<std::string>& names) {
  if (names.empty()) return panels;
  std::vector<Panel> found;
  for (const std::string& name : names)
    for (const Panel& panel : panels)
      if (panel.label == name) found.push_back(panel);
  return found;
}

// The different values of a part of the curves of a panel.
std::set<std::string> all_of(const Panel& panel, std::string Curve::*part) {
  std::set<std::string> names;
  for (const Curve& curve : panel.curves) names.insert(curve.*part);
  return names;
}

std::size_t node_count(const Panel& panel) { return all_of(panel, &Curve::node).size(); }

std::size_t component_count(const Panel& panel) { return all_of(panel, &Curve::component).size(); }

// More nodes than a key can tell apart are drawn as an envelope.
bool is_crowded(const Panel& panel) {
  constexpr std::size_t most_nodes = 6;
  return node_count(panel) > most_nodes && is_node(panel.curves.front().node);
}

// The key tells nodes by colour and components by dash, each once, where there are several of both.
bool has_split_key(const Panel& panel) { return node_count(panel) > 1 && component_count(panel) > 1; }

std::string legend_of(const Panel& panel, const Curve& curve) {
  const bool says_it_all =
      is_node(curve.node) || panel.label == "balance error" || panel.label == "angular momentum";  // in 2D
  if (has_split_key(panel) || (panel.curves.size() == 1 && says_it_all)) return "";
  return component_count(panel) > 1 ? curve.owner + "." + curve.component : curve.owner;
}

// Room for the key on the right; the status needs a row per contact on the left, too.
double height_of(const Panel& panel, const Columns& columns) {
  if (is_crowded(panel)) return curve_height;
  if (panel.quantity == "status")
    return std::max({row_height * static_cast<double>(panel.curves.size()),
                     key_line * static_cast<double>(columns.statuses.size()), 2.0 * key_line});
  const std::size_t lines =
      has_split_key(panel) ? node_count(panel) + component_count(panel) : panel.curves.size();
  return std::max(curve_height, key_line * static_cast<double>(lines));
}

// An impulse belongs to the step that ends at its row's time, a velocity to the half step after it.
const char* style_of(const Panel& panel) {
  if (panel.quantity == "v") return "steps";
  const bool ends_with_row =
      (panel.quantity == "r" && !panel.summed) || panel.quantity == "force" || panel.quantity == "moment";
  return ends_with_row ? "fsteps" : "lines";
}

std::string key_entry(const std::string& name, std::size_t dash, const char* colour) {
  return ", NaN with lines linewidth 1.4 dashtype " + std::to_string(dash) + " linecolor rgb " +
         in_quotes(colour) + " title " + in_quotes(name);
}

// With 0, but for temperatures: they are far from it.
std::string range_of(const Panel& panel) {
  const bool has_zero = panel.quantity != "temperature";
  return std::string("set yrange [") + (has_zero ? "*<0:0<*" : "*:*") + "] noextend\nset ytics autofreq\n";
}

// A colour per node and a dash per component; a colour per component where there is one node.
void draw_curves(std::ostream& script, const Panel& panel) {
  script << range_of(panel);
  const bool many_nodes = node_count(panel) > 1;
  std::size_t node = 0, within = 0;
  std::string key, key_of_components;
  for (std::size_t k = 0; k < panel.curves.size(); ++k) {
    const Curve& curve = panel.curves[k];
    const bool same_node = k > 0 && curve.node == panel.curves[k - 1].node;
    within = same_node ? within + 1 : 0;
    if (k > 0 && !same_node) ++node;
    script << (k == 0 ? "plot " : ", ")
           << "sum = 0, history using 1:" << (panel.summed ? "(sum = sum + $" : "($") << curve.column
           << ") with " << style_of(panel) << " linewidth 1.4 dashtype " << (many_nodes ? within + 1 : 1)
           << " linecolor rgb "
           << in_quotes(curve_colours[(many_nodes ? node : k) % std::size(curve_colours)]) << " title "
           << in_quotes(legend_of(panel, curve));
    if (!has_split_key(panel)) continue;
    if (within == 0) key += key_entry(curve.node, 1, curve_colours[node % std::size(curve_colours)]);
    if (node == 0) key_of_components += key_entry(curve.component, within + 1, "#808080");
  }
  script << key << key_of_components << "\n";
}

// The data block of a component of a crowded panel.
std::string block_of(const Panel& panel, const std::string& component) {
  std::string name = "$band_";
  for (const char c : panel.label + "_" + component)
    name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

// A band per component from the least to the largest of all nodes, and the median.
void draw_envelope(std::ostream& script, const Panel& panel) {
  script << range_of(panel);
  std::size_t k = 0;
  for (const std::string& component : all_of(panel, &Curve::component)) {
    const std::string block = block_of(panel, component), colour = in_quotes(curve_colours[k]);
    script << (k == 0 ? "plot " : ", ") << block << " using 1:2:4 with filledcurves fillcolor rgb " << colour
           << " fillstyle transparent solid 0.2 noborder title '', " << block
           << " using 1:3 with lines linewidth 1.4 linecolor rgb " << colour << " title "
           << in_quotes(component.empty() ? "median" : component);
    k = (k + 1) % std::size(curve_colours);
  }
  script << ", NaN with lines linecolor rgb 'white' title "
         << in_quotes(std::to_string(node_count(panel)) + " nodes") << "\n";
}

StatusRows rows_of(const Panel& panel) {
  StatusRows rows;
  for (const Curve& curve : panel.curves) rows.push_back({curve.owner, curve.column});
  return rows;
}

// The data blocks of what is drawn of many nodes, for one pass through the history, and of
// ruptures. Returns whether there are any of the latter.
bool write_blocks(std::ostream& script, const std::filesystem::path& folder,
                  const std::vector<Panel>& panels) {
  bool has_ruptures = false;
  std::vector<Envelope> envelopes;
  for (const Panel& panel : panels) {
    if (!is_crowded(panel)) {
      if (panel.quantity == "status") has_ruptures = write_ruptures(script, folder, rows_of(panel));
      continue;
    }
    std::map<std::string, std::vector<std::size_t>> columns;
    for (const Curve& curve : panel.curves) columns[curve.component].push_back(curve.column - 1);
    for (const auto& [component, own] : columns)
      envelopes.emplace_back(
          EnvelopeSetup{block_of(panel, component), own, panel.summed, panel.quantity == "status"});
  }
  if (envelopes.empty()) return has_ruptures;
  HistoryFile history(folder / "history.csv");
  for (std::vector<double> row; history.next(row);)
    for (Envelope& envelope : envelopes) envelope.add(row);
  for (const Envelope& envelope : envelopes) envelope.write(script);
  return has_ruptures;
}

// Room for the names of contacts on the left and for the key on the right, whatever their length.
struct Margins {
  double left = least_left, right = least_right;
};

Margins margins_of(const std::vector<Panel>& panels) {
  Margins margins;
  for (const Panel& panel : panels) {
    if (panel.label.size() > longest_label) margins.left = std::max(margins.left, least_left + 17.0);
    for (const Curve& curve : panel.curves) {
      const std::string legend = has_split_key(panel) ? curve.node : legend_of(panel, curve);
      if (is_crowded(panel)) continue;
      if (panel.quantity == "status")
        margins.left = std::max(margins.left, 45.0 + key_letter * static_cast<double>(curve.owner.size()));
      else
        margins.right = std::max(margins.right, 60.0 + key_letter * static_cast<double>(legend.size()));
    }
  }
  return margins;
}

void draw_panels(std::ostream& script, const Sheet& sheet, const Margins& margins, double top,
                 const std::vector<Panel>& panels, const Columns& columns) {
  for (const Panel& panel : panels) {
    const double bottom = top - height_of(panel, columns);
    double label_lines = 1.0;
    const std::string label = in_lines(panel.label, longest_label, label_lines);
    place_panel(script, sheet, {top, bottom, margins.right, 7.0 + 8.0 * label_lines},
                label + (label_lines > 1.0 ? " font ',10'" : ""));
    if (&panel == &panels.back()) script << "set xlabel 'time'\nset format x '%g'\n";
    const bool crowded = is_crowded(panel);
    if (panel.quantity == "status")
      crowded ? draw_counts(script, block_of(panel, ""), panel.curves.size(), columns.statuses)
              : draw_status(script, rows_of(panel), columns.statuses);
    else
      crowded ? draw_envelope(script, panel) : draw_curves(script, panel);
    top = bottom - between;
  }
}

}  // namespace

std::vector<std::string> panel_names(const Columns& columns, int every) {
  std::vector<std::string> names;
  for (const Panel& panel : panels_of(columns, every)) names.push_back(panel.label);
  return names;
}

bool draw_picture(const std::filesystem::path& folder, const std::filesystem::path& pictures,
                  const Columns& found, const Caption& caption) {
  Columns columns = found;
  const std::vector<Panel> panels = chosen(panels_of(columns, caption.every), caption.panels);
  std::ostringstream blocks;
  // Ruptures between rows belong into the key, too.
  if (write_blocks(blocks, folder, panels)) columns.statuses.try_emplace(ILAW_BROKEN, 0);
  const Margins margins = margins_of(panels);
  Sheet sheet{pictures / "history", margins.left + panel_width + margins.right, 0.0};
  double title_lines = 1.0;
  const std::string title =
      in_lines(caption.title, static_cast<std::size_t>(sheet.width / title_letter), title_lines);
  const double above = 23.0 + title_line * title_lines;
  sheet.height = above + below - between;
  for (const Panel& panel : panels) sheet.height += height_of(panel, columns) + between;
  sheet.multiplot = "title " + title + " font ',14' noenhanced";
  sheet.terminal = "rounded";
  sheet.data = blocks.str();
  return draw_sheet(sheet, [&](std::ostream& script) {
    script << "history = " << in_quotes((folder / "history.csv").string()) << "\n"
           << grey_axes << "set xrange [*<0:*] noextend\n"
           << "set offsets graph 0, graph 0, graph 0.06, graph 0.06\nset ytics noenhanced font ',10'\n"
           << "set lmargin at screen " << margins.left / sheet.width << "\nset rmargin at screen "
           << 1.0 - margins.right / sheet.width << "\n";
    draw_panels(script, sheet, margins, sheet.height - above, panels, columns);
  });
}

}  // namespace ilaw::host
