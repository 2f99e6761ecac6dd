! Coupled contacts from Fortran: a column of spheres at rest, a sphere that slides.
module fortran_coupled
  use, intrinsic :: iso_c_binding
  use ilaw_abi
  use ilaw
  use ilaw_coupled
  implicit none
  integer, parameter :: dp = c_double
  integer(c_int), save :: calls = 0 ! of the exchange
contains

  ! Spheres of masses 1, 2, ... on each other, the first on the floor; one step of their weight. impulses of
  ! the contacts from the floor up, velocities and spins after it. slide: of the first, before the step.
  integer(c_int) function fortran_column(count, slide, mu, impulses, v, w, residual) result(code) bind(c)
    integer(c_int), value :: count
    real(c_double), value :: slide, mu
    real(c_double), intent(inout), target :: impulses(3, count), v(3, count), w(3, count)
    real(c_double), intent(out) :: residual
    real(dp), parameter :: h = 1e-3_dp, g = 10, radius = 0.5_dp
    real(dp), target :: inverse_mass(count), inverse_inertia(count), before(3, count), still(3, count)
    real(dp), target :: up(3), down(3), over(3), gap(1), state(0, count)
    integer(c_int32_t), target :: body(count), counterpart(count)
    type(c_ptr) :: interface, solver
    type(ilaw_batch), target :: batch
    type(ilaw_bodies) :: bodies
    type(ilaw_contacts) :: contacts
    type(ilaw_coupled_options) :: options
    type(ilaw_coupled_report) :: report
    type(ilaw_exchange), target :: alone
    integer :: k

    interface = created(mu)
    code = ILAW_NOT_FOUND
    if (.not. c_associated(interface)) return
    up = [0, 0, 1]; down = -radius*up; over = radius*up; gap = 0
    body = [(k, k=1, count)]
    counterpart = body - 1_c_int32_t ! 0: the floor
    inverse_mass = 1/real(body, dp)
    inverse_inertia = 2.5_dp*inverse_mass/radius**2
    v = 0; w = 0; still = 0
    v(1, 1) = slide
    before = v
    v(3, :) = v(3, :) - h*g

    bodies%dimension = 3
    bodies%count = count
    bodies%owned_count = count
    bodies%inverse_mass = ilaw_input_of(inverse_mass)
    bodies%inverse_inertia = ilaw_input_of(inverse_inertia) ! one value each: spheres
    bodies%v_free = ilaw_input_of(v)
    bodies%spin_free = ilaw_input_of(w)
    bodies%v_previous = ilaw_input_of(before)
    bodies%spin_previous = ilaw_input_of(still)
    bodies%velocity = ilaw_output_of(v)
    bodies%spin = ilaw_output_of(w)

    batch%node_count = count
    batch%velocity_step = h
    batch%position_step = h
    batch%gap = ilaw_uniform(gap)
    batch%normal = ilaw_uniform(up)
    batch%state_in = ilaw_input_of(state)
    batch%state_out = ilaw_output_of(state)
    impulses = 0
    batch%impulse = ilaw_output_of(impulses)
    contacts = ilaw_contacts_of(interface, ILAW_DELASSUS_FULL, batch, body, counterpart)
    contacts%arm = ilaw_uniform(down)
    contacts%counterpart_arm = ilaw_uniform(over)
    options%most_sweeps = 20000
    options%tolerance = 1e-14_dp
    alone%sum_bodies = c_funloc(agree); alone%largest = c_funloc(agree); alone%sum = c_funloc(agree)
    options%exchange = c_loc(alone)
    calls = 0
    solver = ilaw_coupled_create()
    code = ilaw_solve(solver, bodies, [contacts], options, report)
    residual = report%residual
    if (calls == 0) code = ILAW_INVALID_ARGUMENT
    call ilaw_coupled_destroy(solver)
    call ilaw_interface_destroy(interface)
  end function

  ! One rank agrees with itself.
  subroutine agree(context, values, count) bind(c)
    type(c_ptr), value :: context
    real(c_double), intent(inout) :: values(*)
    integer(c_int64_t), value :: count
    if (count > 0 .and. .not. c_associated(context)) values(1) = values(1)
    calls = calls + 1_c_int
  end subroutine

  type(c_ptr) function created(mu) result(interface)
    real(dp), intent(in) :: mu
    character(256) :: message
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    type(ilaw_values) :: values
    interface = c_null_ptr
    if (ilaw_open('coulomb', library, message) /= ILAW_OK) return
    setup%dimension = 3
    setup%delassus_form = ILAW_DELASSUS_FULL
    setup%frame = ILAW_FRAME_GLOBAL
    call values%set('friction', mu)
    if (ilaw_create(library, '', setup, values, interface, message) /= ILAW_OK) interface = c_null_ptr
    call ilaw_library_close(library)
  end function
end module
