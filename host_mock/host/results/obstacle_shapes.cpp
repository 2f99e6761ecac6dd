// SPDX-License-Identifier: BSD-3-Clause
#include "results/obstacle_shapes.hpp"

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>

namespace ilaw::host {
namespace {

using Point = Eigen::Vector3d;

constexpr int round_parts = 32;  // of a circle

Point in_3d(const Vector& vector) {
  Point point = Point::Zero();
  point.head(vector.size()) = vector;
  return point;
}

// Where the bodies are at the start, and how large they are together.
struct Bodies {
  Point centre = Point::Zero();
  double size = 0.0;

  explicit Bodies(const Model& model) {
    const Eigen::Index d = model.dimension();
    const Eigen::Map<const Eigen::MatrixXd> x(model.position().data(), d, model.position().size() / d);
    const Vector low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
    centre = in_3d(0.5 * (low + high));
    size = (high - low).norm();
  }
};

class Shapes {
 public:
  Shapes(vtkUnstructuredGrid& grid, int dimension, const Bodies& bodies)
      : grid_(grid), dimension_(dimension), bodies_(bodies) {
    points_->SetDataTypeToDouble();
    interface_->SetName("interface");
  }

  void add(const ObstacleShape& shape, int number) {
    number_ = number;
    const Point point = in_3d(shape.point);
    if (shape.radius == 0.0)
      add_plane(point, in_3d(shape.direction));
    else if (shape.direction.size() == 0)
      add_sphere(point, shape.radius);
    else
      add_cylinder(point, in_3d(shape.direction), shape.radius);
  }

  void finish() {
    grid_.SetPoints(points_);
    grid_.GetCellData()->AddArray(interface_);
  }

 private:
  vtkIdType point(const Point& x) { return points_->InsertNextPoint(x.data()); }

  void cell(int type, std::initializer_list<vtkIdType> nodes) {
    grid_.InsertNextCell(type, static_cast<vtkIdType>(nodes.size()), nodes.begin());
    interface_->InsertNextValue(number_);
  }

  // Two directions across one, right-handed with it.
  static std::pair<Point, Point> across(const Point& axis) {
    const Point first = axis.unitOrthogonal();
    return {first, axis.cross(first)};
  }

  // How far a surface that has no end is drawn from a point of it.
  double reach(const Point& on_surface) const {
    const double size = std::max(bodies_.size, (bodies_.centre - on_surface).norm());
    return size > 0.0 ? size : 1.0;
  }

  void add_plane(const Point& point_on_it, const Point& normal) {
    const Point centre = bodies_.centre - (bodies_.centre - point_on_it).dot(normal) * normal;
    if (dimension_ == 1) return cell(VTK_VERTEX, {point(centre)});
    const double size = reach(centre);
    if (dimension_ == 2) {
      const Point along = size * Point(-normal[1], normal[0], 0.0);
      return cell(VTK_LINE, {point(centre - along), point(centre + along)});
    }
    const auto [first, second] = across(normal);
    const Point a = size * first, b = size * second;
    cell(VTK_QUAD,
         {point(centre - a - b), point(centre + a - b), point(centre + a + b), point(centre - a + b)});
  }

  // Nodes of a circle, one after the other.
  vtkIdType add_circle(const Point& centre, double radius, const Point& first, const Point& second) {
    const vtkIdType start = points_->GetNumberOfPoints();
    for (int k = 0; k < round_parts; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / round_parts;
      point(centre + radius * (std::cos(angle) * first + std::sin(angle) * second));
    }
    return start;
  }

  // The band between two circles.
  void join(vtkIdType lower, vtkIdType upper) {
    for (int k = 0; k < round_parts; ++k) {
      const int next = (k + 1) % round_parts;
      cell(VTK_QUAD, {lower + k, lower + next, upper + next, upper + k});
    }
  }

  void add_sphere(const Point& centre, double radius) {
    if (dimension_ == 1) {
      cell(VTK_VERTEX, {point(centre - radius * Point::UnitX())});
      return cell(VTK_VERTEX, {point(centre + radius * Point::UnitX())});
    }
    if (dimension_ == 2) {
      const vtkIdType start = add_circle(centre, radius, Point::UnitX(), Point::UnitY());
      for (int k = 0; k < round_parts; ++k) cell(VTK_LINE, {start + k, start + (k + 1) % round_parts});
      return;
    }
    constexpr int bands = round_parts / 2;
    vtkIdType below = 0;
    for (int k = 0; k <= bands; ++k) {
      const double angle = std::numbers::pi * k / bands;
      const vtkIdType circle = add_circle(centre - radius * std::cos(angle) * Point::UnitZ(),
                                          radius * std::sin(angle), Point::UnitX(), Point::UnitY());
      if (k > 0) join(below, circle);
      below = circle;
    }
  }

  void add_cylinder(const Point& point_on_axis, const Point& axis, double radius) {
    const Point centre = point_on_axis + (bodies_.centre - point_on_axis).dot(axis) * axis;
    const auto [first, second] = across(axis);
    const Point half = std::max(reach(centre), radius) * axis;
    const vtkIdType start = add_circle(centre - half, radius, first, second);
    join(start, add_circle(centre + half, radius, first, second));
  }

  vtkUnstructuredGrid& grid_;
  int dimension_;
  const Bodies& bodies_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkIntArray> interface_;
  int number_ = 0;
};

const Obstacle* obstacle_of(const Interface& interface) { return interface.setup().counterpart->obstacle(); }

}  // namespace

bool has_obstacles(const Scene& scene) {
  return std::ranges::any_of(scene.interfaces, [](const auto& one) { return obstacle_of(*one) != nullptr; });
}

bool has_moving_obstacles(const Scene& scene) {
  return std::ranges::any_of(scene.interfaces, [](const auto& one) {
    return obstacle_of(*one) && !obstacle_of(*one)->looks_the_same();
  });
}

void add_obstacles(vtkUnstructuredGrid& grid, const Scene& scene, double time) {
  const Bodies bodies(*scene.model);
  Shapes shapes(grid, scene.model->dimension(), bodies);
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i)
    if (const Obstacle* const obstacle = obstacle_of(*scene.interfaces[i]))
      shapes.add(obstacle->shape(time), static_cast<int>(i));
  shapes.finish();
}

}  // namespace ilaw::host
