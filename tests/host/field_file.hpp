// field_file.hpp - what stands in a VTK file, read back with VTK itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "host_runner.hpp"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <stdexcept>

namespace ilaw::host::testing {

inline vtkSmartPointer<vtkUnstructuredGrid> grid_of(const fs::path& file) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  EXPECT_TRUE(reader->CanReadFile(file.c_str())) << file;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

class Field {
 public:
  Field(vtkUnstructuredGrid& grid, const std::string& name, int components)
      : array_(grid.GetPointData()->GetArray(name.c_str())) {
    if (!array_) throw std::runtime_error("no array " + name);
    EXPECT_EQ(array_->GetNumberOfComponents(), components) << name;
    EXPECT_EQ(array_->GetNumberOfTuples(), grid.GetNumberOfPoints()) << name;
  }
  double at(int node, int component = 0) const { return array_->GetComponent(node, component); }

 private:
  vtkDataArray* array_;
};

inline vtkDataArray& cells_of(vtkUnstructuredGrid& grid, const char* name) {
  vtkDataArray* array = grid.GetCellData()->GetArray(name);
  if (!array) throw std::runtime_error(std::string("no array ") + name);
  EXPECT_EQ(array->GetNumberOfTuples(), grid.GetNumberOfCells());
  return *array;
}

inline std::string block_of(const std::string& material, const std::string& element = "full") {
  return R"({"model": {"type": "blocks", "blocks": [{"name": "b", "corner": [0.3, -0.2, 0.1], "size": [0.2, 0.1, 0.3],
      "elements": [2, 1, 3], "element": ")" +
         element + R"(", "material": {"type": ")" + material +
         R"(", "young": 2e6, "poisson": 0.3, "density": 1000}}]}, "time": {"cfl": 0.5, "end": 1e-3}, "interfaces": []})";
}

}  // namespace ilaw::host::testing
