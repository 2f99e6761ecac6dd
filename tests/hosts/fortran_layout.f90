! Offsets of the members of every struct, as the Fortran compiler lays them out, and default values.
module fortran_layout
  use, intrinsic :: iso_c_binding
  use ilaw_abi
  implicit none
contains

  pure function at(members, base) result(offsets)
    type(c_ptr), intent(in) :: members(:), base
    integer(c_int64_t) :: offsets(size(members))
    integer :: k
    do k = 1, size(members)
      offsets(k) = transfer(members(k), 0_c_intptr_t) - transfer(base, 0_c_intptr_t)
    end do
  end function

  ! The structs in the order of the header; size in bytes, then the offsets of the members.
  integer(c_int) function fortran_layout_of(struct, layout) result(count) bind(c)
    integer(c_int), value :: struct
    integer(c_int64_t), intent(out) :: layout(64)
    integer(c_int64_t), allocatable :: found(:)
    select case (struct)
    case (0); found = parameter_layout()
    case (1); found = state_variable_layout()
    case (2); found = argument_layout()
    case (3); found = setup_layout()
    case (4); found = info_layout()
    case (5); found = input_layout()
    case (6); found = output_layout()
    case (7); found = batch_layout()
    case (8); found = report_layout()
    case (9); found = law_layout()
    case default; found = plugin_layout()
    end select
    count = size(found)
    layout = 0
    layout(:count) = found
  end function

  function parameter_layout() result(layout)
    type(ilaw_parameter), target :: p
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(p), at([ &
      c_loc(p%struct_size), c_loc(p%kind), c_loc(p%name), c_loc(p%symbol), c_loc(p%unit), c_loc(p%doc), &
      c_loc(p%minimum), c_loc(p%maximum), c_loc(p%default_value), c_loc(p%required), &
      c_loc(p%minimum_excluded), c_loc(p%infinity_allowed), c_loc(p%may_be), c_loc(p%choices), &
      c_loc(p%choice_count), c_loc(p%reserved)], c_loc(p))]
  end function

  function state_variable_layout() result(layout)
    type(ilaw_state_variable), target :: s
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(s), at([c_loc(s%struct_size), c_loc(s%kind), c_loc(s%name), c_loc(s%unit), &
                               c_loc(s%doc), c_loc(s%count), c_loc(s%flags), c_loc(s%reserved)], c_loc(s))]
  end function

  function argument_layout() result(layout)
    type(ilaw_argument), target :: a
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(a), at([c_loc(a%struct_size), c_loc(a%kind), c_loc(a%name), c_loc(a%number), &
                               c_loc(a%text), c_loc(a%values), c_loc(a%count)], c_loc(a))]
  end function

  function setup_layout() result(layout)
    type(ilaw_setup), target :: s
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(s), at([ &
      c_loc(s%struct_size), c_loc(s%dimension), c_loc(s%delassus_form), c_loc(s%frame), &
      c_loc(s%flags), c_loc(s%arguments), c_loc(s%argument_count), c_loc(s%tangent_given)], c_loc(s))]
  end function

  function info_layout() result(layout)
    type(ilaw_instance_info), target :: i
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(i), at([ &
      c_loc(i%struct_size), c_loc(i%inputs), c_loc(i%energy_inputs), c_loc(i%state_variable_count), &
      c_loc(i%state_size), c_loc(i%state_variables), c_loc(i%per_node_parameters), &
      c_loc(i%per_node_parameter_count), c_loc(i%capabilities), c_loc(i%state_version), c_loc(i%reserved)], c_loc(i))]
  end function

  function input_layout() result(layout)
    type(ilaw_input), target :: i
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(i), at([c_loc(i%values), c_loc(i%node_stride), c_loc(i%component_stride)], c_loc(i))]
  end function

  function output_layout() result(layout)
    type(ilaw_output), target :: o
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(o), at([c_loc(o%values), c_loc(o%node_stride), c_loc(o%component_stride)], c_loc(o))]
  end function

  function batch_layout() result(layout)
    type(ilaw_batch), target :: b
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(b), at([ &
      c_loc(b%struct_size), c_loc(b%index_base), c_loc(b%flags), c_loc(b%node_count), c_loc(b%index), &
      c_loc(b%index64), c_loc(b%time), &
      c_loc(b%velocity_step), c_loc(b%position_step), c_loc(b%v_free), c_loc(b%delassus), c_loc(b%gap), &
      c_loc(b%gap_offset), c_loc(b%v_previous), c_loc(b%area), c_loc(b%normal), c_loc(b%tangent), &
      c_loc(b%per_node_parameters), c_loc(b%state_in), c_loc(b%state_out), c_loc(b%impulse), &
      c_loc(b%velocity), c_loc(b%energy), c_loc(b%status), c_loc(b%status_stride)], c_loc(b))]
  end function

  function report_layout() result(layout)
    type(ilaw_report), target :: r
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(r), at([c_loc(r%struct_size), c_loc(r%reserved), c_loc(r%bad_count), &
                               c_loc(r%first_bad_node), c_loc(r%reason), &
                               c_loc(r%stable_velocity_step)], c_loc(r))]
  end function

  function law_layout() result(layout)
    type(ilaw_law), target :: l
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(l), at([ &
      c_loc(l%struct_size), c_loc(l%dimensions), c_loc(l%delassus_forms), c_loc(l%inputs), c_loc(l%outputs), &
      c_loc(l%capabilities), c_loc(l%id), c_loc(l%title), c_loc(l%doc), c_loc(l%references), &
      c_loc(l%parameters), c_loc(l%state_variables), c_loc(l%reference_count), c_loc(l%parameter_count), &
      c_loc(l%state_variable_count), c_loc(l%reserved), c_loc(l%create), c_loc(l%destroy), c_loc(l%info), &
      c_loc(l%initialise), c_loc(l%evaluate), c_loc(l%extension)], c_loc(l))]
  end function

  function plugin_layout() result(layout)
    type(ilaw_plugin), target :: p
    integer(c_int64_t), allocatable :: layout(:)
    layout = [c_sizeof(p), at([ &
      c_loc(p%struct_size), c_loc(p%abi_major), c_loc(p%abi_minor), c_loc(p%name), c_loc(p%version), &
      c_loc(p%vendor), c_loc(p%licence), c_loc(p%laws), c_loc(p%law_count), c_loc(p%reserved), &
      c_loc(p%extension)], c_loc(p))]
  end function

  ! struct_size of variables that are merely declared, in the order of the header; -1 for the two without.
  subroutine fortran_struct_sizes(sizes) bind(c)
    integer(c_int32_t), intent(out) :: sizes(11)
    type(ilaw_parameter) :: parameter_
    type(ilaw_state_variable) :: state_variable
    type(ilaw_argument) :: argument
    type(ilaw_setup) :: setup
    type(ilaw_instance_info) :: info
    type(ilaw_batch) :: batch
    type(ilaw_report) :: report
    type(ilaw_law) :: law
    type(ilaw_plugin) :: plugin
    sizes = [parameter_%struct_size, state_variable%struct_size, argument%struct_size, setup%struct_size, &
             info%struct_size, -1, -1, batch%struct_size, report%struct_size, law%struct_size, &
             plugin%struct_size]
  end subroutine

  type(ilaw_batch) function fortran_default_batch() result(batch) bind(c)
    batch = ilaw_batch()
  end function
end module fortran_layout
