! ilaw_coupled.f90 - contacts that share bodies (<ilaw/coupled.h>) for Fortran 2008: groups of contacts from arrays
! that go in without a copy. Structs and constants are in ilaw_coupled_abi; coupled.h says what they mean.
!
! Bodies count from 1, as the batch's index_base has it, and a counterpart of 0 is a wall. Links with
! -lilaw_coupled beside the loader.
!
! SPDX-License-Identifier: BSD-3-Clause
module ilaw_coupled
  use, intrinsic :: iso_c_binding
  use ilaw_abi
  use ilaw_coupled_abi
  implicit none

contains

  ! The contacts of one law. The batch has the arrays of the contacts (gap, normal, state, impulse, ...) and
  ! their number in node_count. All arguments but the interface are used where they are: they need the target
  ! attribute and live as long as the result is used. Arms and the motion of walls are set in the result.
  function ilaw_contacts_of(interface, delassus_form, batch, body, counterpart) result(contacts)
    type(c_ptr), intent(in) :: interface
    integer(c_int32_t), intent(in) :: delassus_form ! that of the interface
    type(ilaw_batch), intent(in), target :: batch
    integer(c_int32_t), intent(in), target, contiguous :: body(:), counterpart(:)
    type(ilaw_contacts) :: contacts
    contacts%delassus_form = delassus_form
    contacts%law = ilaw_interface_law(interface)
    contacts%instance = ilaw_interface_instance(interface)
    contacts%batch = c_loc(batch)
    if (size(body) > 0) contacts%body = c_loc(body)
    if (size(counterpart) > 0) contacts%counterpart = c_loc(counterpart)
  end function

  ! Solves a step: ilaw_coupled_solve with an array of groups.
  integer(c_int32_t) function ilaw_solve(solver, bodies, groups, options, report) result(code)
    type(c_ptr), intent(in) :: solver
    type(ilaw_bodies), intent(in), target :: bodies
    type(ilaw_contacts), intent(in), target :: groups(:)
    type(ilaw_coupled_options), intent(in), target :: options
    type(ilaw_coupled_report), intent(inout) :: report
    type(c_ptr) :: pointers(size(groups))
    integer :: g
    do g = 1, size(groups)
      pointers(g) = c_loc(groups(g))
    end do
    code = ilaw_coupled_solve(solver, bodies, pointers, size(groups, kind=c_int64_t), options, report)
  end function
end module
