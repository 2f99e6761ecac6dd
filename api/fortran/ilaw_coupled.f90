! ilaw_coupled.f90 - contacts that share bodies (<ilaw/coupled.h>) for Fortran 2008: structs, functions, and
! groups of contacts from arrays that go in without a copy. coupled.h says what each member means.
!
! Bodies count from 1, as the batch's index_base has it, and a counterpart of 0 is a wall. Links with
! -lilaw_coupled beside the loader.
!
! SPDX-License-Identifier: BSD-3-Clause
module ilaw_coupled
  use, intrinsic :: iso_c_binding
  use ilaw_abi
  use ilaw, only: ilaw_interface_law
  implicit none

  type, bind(c) :: ilaw_bodies
    integer(c_int32_t) :: struct_size = 264, dimension = 0
    integer(c_int64_t) :: count = 0, owned_count = 0
    type(ilaw_input) :: inverse_mass, inverse_inertia, v_free, spin_free, v_previous, spin_previous
    type(ilaw_output) :: velocity, spin, impulse, angular_impulse
  end type

  type, bind(c) :: ilaw_contacts
    integer(c_int32_t) :: struct_size = 144, delassus_form = 0
    type(c_ptr) :: law = c_null_ptr, instance = c_null_ptr, batch = c_null_ptr
    type(c_ptr) :: body = c_null_ptr, counterpart = c_null_ptr ! integer(c_int32_t)
    type(ilaw_input) :: arm, counterpart_arm, wall_velocity, wall_previous
  end type

  type, bind(c) :: ilaw_exchange
    integer(c_int32_t) :: struct_size = 40, reserved = 0
    type(c_ptr) :: context = c_null_ptr
    ! Of procedures with the interface ilaw_exchanger: c_funloc.
    type(c_funptr) :: sum_bodies = c_null_funptr, largest = c_null_funptr, sum = c_null_funptr
  end type

  type, bind(c) :: ilaw_coupled_options
    integer(c_int32_t) :: struct_size = 24, most_sweeps = 0
    real(c_double) :: tolerance = 0
    type(c_ptr) :: exchange = c_null_ptr ! to an ilaw_exchange
  end type

  type, bind(c) :: ilaw_coupled_report
    integer(c_int32_t) :: struct_size = 96, sweeps = 0
    real(c_double) :: residual = 0, work = 0, energy(0:ILAW_ENERGY_COUNT - 1) = 0
    integer(c_int64_t) :: bad_count = 0, bad_group = -1, bad_contact = -1 ! the last two count from 0
    type(c_ptr) :: reason = c_null_ptr ! text: ilaw_text
    real(c_double) :: stable_velocity_step = 0
  end type

  abstract interface
    ! sum_bodies: values has `count` values per body; largest and sum: `count` in all.
    subroutine ilaw_exchanger(context, values, count) bind(c)
      import :: c_ptr, c_double, c_int64_t
      type(c_ptr), value :: context
      real(c_double), intent(inout) :: values(*)
      integer(c_int64_t), value :: count
    end subroutine
  end interface

  interface
    ! Null: out of memory.
    type(c_ptr) function ilaw_coupled_create() bind(c, name='ilaw_coupled_create')
      import :: c_ptr
    end function

    subroutine ilaw_coupled_destroy(solver) bind(c, name='ilaw_coupled_destroy')
      import :: c_ptr
      type(c_ptr), value :: solver
    end subroutine

    type(c_ptr) function ilaw_interface_instance(interface) bind(c, name='ilaw_interface_instance')
      import :: c_ptr
      type(c_ptr), value :: interface
    end function
  end interface

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
    type(ilaw_bodies), intent(in) :: bodies
    type(ilaw_contacts), intent(in), target :: groups(:)
    type(ilaw_coupled_options), intent(in) :: options
    type(ilaw_coupled_report), intent(inout) :: report
    interface
      integer(c_int32_t) function ilaw_coupled_solve(solver, bodies, groups, group_count, options, report) &
        bind(c, name='ilaw_coupled_solve')
        import :: c_ptr, c_int32_t, c_int64_t, ilaw_bodies, ilaw_coupled_options, ilaw_coupled_report
        type(c_ptr), value :: solver
        type(ilaw_bodies), intent(in) :: bodies
        type(c_ptr), intent(in) :: groups(*)
        integer(c_int64_t), value :: group_count
        type(ilaw_coupled_options), intent(in) :: options
        type(ilaw_coupled_report), intent(inout) :: report
      end function
    end interface
    type(c_ptr) :: pointers(size(groups))
    integer :: g
    do g = 1, size(groups)
      pointers(g) = c_loc(groups(g))
    end do
    code = ilaw_coupled_solve(solver, bodies, pointers, size(groups, kind=c_int64_t), options, report)
  end function
end module
