! ilaw_coupled_abi.f90 - structs and functions of coupled contacts, for Fortran 2008.
!
! Made by api/bindings/generate.py from <ilaw/coupled.h>: do not edit, change the header and
! run the script. The header says what each member means, in which unit and who owns it. Every type is
! interoperable with the C struct of the same name on 64-bit machines. Declared variables have their struct_size,
! null pointers and index_base 1. Texts are pointers to C strings: ilaw_text (module ilaw) reads them.
!
! SPDX-License-Identifier: BSD-3-Clause
module ilaw_coupled_abi
  use, intrinsic :: iso_c_binding
  use ilaw_abi
  implicit none
  public

  integer(c_int32_t), parameter :: &
    ILAW_METHOD_GAUSS_SEIDEL = 0, ILAW_METHOD_CONJUGATE = 1, ILAW_METHOD_ANDERSON = 2, &
    ILAW_METHOD_DOUGLAS_RACHFORD = 3, ILAW_METHOD_NEWTON = 4

  type, bind(c) :: ilaw_bodies
    integer(c_int32_t) :: struct_size = 352
    integer(c_int32_t) :: dimension = 0
    integer(c_int64_t) :: count = 0
    integer(c_int64_t) :: owned_count = 0
    type(c_ptr) :: id = c_null_ptr
    type(ilaw_input) :: inverse_mass
    type(ilaw_input) :: inverse_inertia
    type(ilaw_input) :: v_free
    type(ilaw_input) :: spin_free
    type(ilaw_input) :: v_previous
    type(ilaw_input) :: spin_previous
    type(ilaw_output) :: velocity
    type(ilaw_output) :: spin
    type(ilaw_output) :: impulse
    type(ilaw_output) :: angular_impulse
  end type

  type, bind(c) :: ilaw_contacts
    integer(c_int32_t) :: struct_size = 320
    integer(c_int32_t) :: delassus_form = 0
    type(c_ptr) :: law = c_null_ptr
    type(c_ptr) :: instance = c_null_ptr
    type(c_ptr) :: batch = c_null_ptr
    type(c_ptr) :: body = c_null_ptr
    type(c_ptr) :: counterpart = c_null_ptr
    type(ilaw_input) :: arm
    type(ilaw_input) :: counterpart_arm
    type(ilaw_input) :: wall_velocity
    type(ilaw_input) :: wall_previous
    type(ilaw_input) :: wall_spin
    type(ilaw_input) :: wall_spin_previous
    integer(c_int32_t) :: body_count = 0
    integer(c_int32_t) :: counterpart_count = 0
    type(ilaw_input) :: body_weight
    type(ilaw_input) :: counterpart_weight
    integer(c_int32_t) :: weight_size = 0
    integer(c_int32_t) :: reserved = 0
  end type

  type, bind(c) :: ilaw_exchange
    integer(c_int32_t) :: struct_size = 40
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: context = c_null_ptr
    type(c_funptr) :: sum_bodies = c_null_funptr
    type(c_funptr) :: largest = c_null_funptr
    type(c_funptr) :: sum = c_null_funptr
  end type

  type, bind(c) :: ilaw_threads
    integer(c_int32_t) :: struct_size = 24
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: context = c_null_ptr
    type(c_funptr) :: run = c_null_funptr
  end type

  type, bind(c) :: ilaw_coupled_options
    integer(c_int32_t) :: struct_size = 56
    integer(c_int32_t) :: most_sweeps = 0
    real(c_double) :: tolerance = 0
    type(c_ptr) :: exchange = c_null_ptr
    real(c_double) :: speed = 0
    real(c_double) :: rounding = 0
    integer(c_int32_t) :: threads = 0
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: pool = c_null_ptr
  end type

  type, bind(c) :: ilaw_coupled_report
    integer(c_int32_t) :: struct_size = 184
    integer(c_int32_t) :: sweeps = 0
    real(c_double) :: residual = 0
    real(c_double) :: work = 0
    real(c_double) :: energy(0:3) = 0
    integer(c_int64_t) :: bad_count = 0
    integer(c_int64_t) :: bad_group = -1
    integer(c_int64_t) :: bad_contact = -1
    type(c_ptr) :: reason = c_null_ptr
    real(c_double) :: stable_velocity_step = 0
    integer(c_int32_t) :: method = 0
    integer(c_int32_t) :: stalled = 0
    integer(c_int64_t) :: worst_group = -1
    integer(c_int64_t) :: worst_contact = -1
    type(c_ptr) :: law = c_null_ptr
    type(c_ptr) :: other_law = c_null_ptr
    real(c_double) :: speed = 0
    real(c_double) :: first_speed = 0
    real(c_double) :: energy_error = 0
    integer(c_int64_t) :: island_contacts = 0
    real(c_double) :: mass_ratio = 0
    type(c_ptr) :: message = c_null_ptr
  end type

  abstract interface
    subroutine ilaw_sum_bodies_function(context, values, components) bind(c)
      import :: c_double, c_int64_t, c_ptr
      type(c_ptr), value :: context
      real(c_double), intent(inout) :: values(*)
      integer(c_int64_t), value :: components
    end subroutine
    subroutine ilaw_reduce_function(context, values, count) bind(c)
      import :: c_double, c_int64_t, c_ptr
      type(c_ptr), value :: context
      real(c_double), intent(inout) :: values(*)
      integer(c_int64_t), value :: count
    end subroutine
    subroutine ilaw_work_function(work, thread, count) bind(c)
      import :: c_int32_t, c_ptr
      type(c_ptr), value :: work
      integer(c_int32_t), value :: thread
      integer(c_int32_t), value :: count
    end subroutine
    subroutine ilaw_run_function(context, threads, part, work) bind(c)
      import :: c_funptr, c_int32_t, c_ptr
      type(c_ptr), value :: context
      integer(c_int32_t), value :: threads
      type(c_funptr), value :: part
      type(c_ptr), value :: work
    end subroutine
  end interface

  interface
    type(c_ptr) function ilaw_coupled_create() bind(c, name='ilaw_coupled_create')
      import :: c_ptr
    end function
    subroutine ilaw_coupled_destroy(solver) bind(c, name='ilaw_coupled_destroy')
      import :: c_ptr
      type(c_ptr), value :: solver
    end subroutine
    integer(c_int32_t) function ilaw_coupled_solve(solver, bodies, groups, group_count, options, report) &
      bind(c, name='ilaw_coupled_solve')
      import :: c_int32_t, c_int64_t, c_ptr, ilaw_bodies, ilaw_coupled_options, ilaw_coupled_report
      type(c_ptr), value :: solver
      type(ilaw_bodies), intent(in), target :: bodies
      type(c_ptr), intent(in), target :: groups(*)
      integer(c_int64_t), value :: group_count
      type(ilaw_coupled_options), intent(in), target :: options
      type(ilaw_coupled_report), intent(inout), target :: report
    end function
  end interface
end module ilaw_coupled_abi
