"""Bad scene files and what is said of each, after the file's name: the table of several tests."""

GOOD_CIRCLE = 'circles: [{position: [0, 0], radius: 1}]\n'

# A word repeated ten to the power of nine times, if anybody followed the aliases.
LAUGHS = 'a: &a [lol, lol]\n' + ''.join(
    f'{key}: &{key} [{", ".join(["*" + inner] * 10)}]\n'
    for inner, key in zip('abcdefgh', 'bcdefghi', strict=True)
)

BAD_FILES: dict[str, tuple[str | bytes, str]] = {
    'empty': ('', 'must have circles or groups, got an empty file'),
    'only_a_comment': ('# nothing\n', 'must have circles or groups, got an empty file'),
    'null': ('---\n', 'must be a mapping, got nothing'),
    'list': ('[1, 2]\n', 'must be a mapping, got [1, 2]'),
    'text': ('hello\n', "must be a mapping, got 'hello'"),
    'nothing_to_show': ('walls: []\n', 'must have circles or groups, got the key walls'),
    'not_yaml': (
        'circles: [{position: [0, 0}]\n',
        "line 1, column 27: must be valid YAML, got an error: expected ',' or ']', but got '}'",
    ),
    'tab': (
        'circles:\n\t- radius: 1\n',
        "line 2, column 1: must be valid YAML, got an error: found character '\\t' that "
        'cannot start any token',
    ),
    'escape_beyond_unicode': (
        'circles: [{name: "\\U00110000", position: [0, 0], radius: 0.1}]\n',
        'line 1, column 21: must be valid YAML, got an error: an escape or a version is out of range',
    ),
    'escape_beyond_c': (
        '"\\UFFFFFFFF": 1\n',
        'line 1, column 4: must be valid YAML, got an error: an escape or a version is out of range',
    ),
    'half_a_character': (
        'circles: []\ndescription: "\\ud83d"\n',
        "description: must be Unicode text, got '\\ud83d'",
    ),
    'half_a_character_as_key': (
        'circles: [{"\\udc00": 1}]\n',
        "circles[0]: must be Unicode text, got '\\udc00'",
    ),
    'long_version': (
        '%YAML 1.' + '9' * 5000 + '\n---\n' + GOOD_CIRCLE,
        'line 1, column 9: must be valid YAML, got an error: an escape or a version is out of range',
    ),
    'two_documents': (
        GOOD_CIRCLE + '---\n' + GOOD_CIRCLE,
        'must be one YAML document, got a second one on line 2',
    ),
    'not_utf8': (b'circles:\n- name: gr\xfcn\n', 'line 2: must be UTF-8 text, got the byte 0xfc'),
    'binary': (
        b'\x7fELF\x02\x01\x01\x00\x00',
        "line 1: must be printable text, got the character '\\x7f'",
    ),
    'zeros': (bytes(100), "line 1: must be printable text, got the character '\\x00'"),
    'utf16': ('circles: []'.encode('utf-16'), 'line 1: must be UTF-8 text, got the byte 0xff'),
    'laughs': (LAUGHS, "a: must have no anchor, got '&a'"),
    'alias': (
        'circles: [{position: [0, 0], radius: *r}]\n',
        "circles[0].radius: must be written out, got the alias '*r'",
    ),
    'tag': (
        'circles: !!python/object/apply:os.system [ls]\n',
        "circles: must have no YAML tag, got 'tag:yaml.org,2002:python/object/apply:os.system'",
    ),
    'float_tag': (
        'circles: [{position: [0, 0], radius: !!float 1}]\n',
        "circles[0].radius: must have no YAML tag, got 'tag:yaml.org,2002:float'",
    ),
    'nested': ('[' * 100_000, 'must be nested at most 20 deep, got more'),
    'duplicate_key': (
        'circles:\n- {position: [0, 0], radius: 1,\n   radius: 2}\n',
        'circles[0].radius: must be given once, got it again on line 3',
    ),
    'duplicate_section': (
        GOOD_CIRCLE + 'walls: []\n' + GOOD_CIRCLE,
        'circles: must be given once, got it again on line 3',
    ),
    'list_as_key': (
        '? [a, b]\n: 1\n',
        'must have words for keys, got a list, a mapping or an alias',
    ),
    'merge_key': (
        'circles: [{position: [0, 0], radius: 1, <<: {mass: 1}}]\n',
        "circles[0].'<<': must be one of the keys name, position, velocity, radius, mass, "
        'locked, got an unknown key',
    ),
    'unknown_key': (
        'circles: [{position: [0, 0], raduis: 1, radius: 1}]\n',
        'circles[0].raduis: must be one of the keys name, position, velocity, radius, mass, '
        'locked, got an unknown key',
    ),
    'unknown_section': (
        GOOD_CIRCLE + 'gravity: 9.81\n',
        'gravity: must be one of the keys description, circles, walls, groups, '
        'moving_circles_collide, restart_after, seed, got an unknown key',
    ),
    'unprintable_key': (
        GOOD_CIRCLE + '"a\\nb": 1\n',
        "'a\\nb': must be one of the keys description, circles, walls, groups, "
        'moving_circles_collide, restart_after, seed, got an unknown key',
    ),
    'long_key': (
        f'? {"k" * 2000}\n: 1\n',
        f'{"k" * 57}...: must be one of the keys description, circles, walls, groups, '
        'moving_circles_collide, restart_after, seed, got an unknown key',
    ),
    'circles_a_mapping': (
        'circles: {position: [0, 0], radius: 1}\n',
        'circles: must be a list, got the keys position, radius',
    ),
    'circles_nothing': ('circles:\n', 'circles: must be a list, got nothing'),
    'circle_a_number': ('circles: [7]\n', 'circles[0]: must be a mapping, got 7'),
    'no_circle_moves': ('circles: []\n', 'circles: at least one must move, got none'),
    'all_locked': (
        'circles: [{position: [0, 0], radius: 1, locked: true}]\n',
        'circles: at least one must move, got 1, all locked',
    ),
    'no_radius': (
        'circles: [{position: [0, 0]}]\n',
        'circles[0].radius: must be given, got nothing',
    ),
    'no_position': ('circles: [{radius: 1}]\n', 'circles[0].position: must be given, got nothing'),
    'negative_radius': (
        'circles:\n'
        '- {position: [0, 0], radius: 1}\n'
        '- {position: [3, 0], radius: 1}\n'
        '- {position: [6, 0], radius: -0.1}\n',
        'circles[2].radius: must be > 0 m, got -0.1',
    ),
    'zero_radius': (
        'circles: [{position: [0, 0], radius: 0}]\n',
        'circles[0].radius: must be > 0 m, got 0',
    ),
    'tiny_radius': (
        'circles: [{position: [0, 0], radius: 1e-300}]\n',
        'circles[0].radius: must be >= 1e-60 m, got 1e-300',
    ),
    'huge_radius': (
        'circles: [{position: [0, 0], radius: 1e61}]\n',
        'circles[0].radius: must be <= 1e+60 m, got 1e+61',
    ),
    'text_radius': (
        'circles: [{position: [0, 0], radius: big}]\n',
        "circles[0].radius: must be a number, got 'big'",
    ),
    'quoted_number': (
        "circles: [{position: [0, 0], radius: '1.0'}]\n",
        "circles[0].radius: must be a number, got '1.0'",
    ),
    'number_with_underscore': (
        'circles: [{position: [0, 0], radius: 1_000}]\n',
        "circles[0].radius: must be a number, got '1_000'",
    ),
    'radius_yes': (
        'circles: [{position: [0, 0], radius: true}]\n',
        'circles[0].radius: must be a number, got true',
    ),
    'radius_range_of_a_circle': (
        'circles: [{position: [0, 0], radius: [1, 2]}]\n',
        'circles[0].radius: must be a number, got [1, 2]',
    ),
    'nan': (
        'circles: [{position: [.nan, 0], radius: 1}]\n',
        'circles[0].position[0]: must be finite, got .nan',
    ),
    'nan_word': (
        'circles: [{position: [nan, 0], radius: 1}]\n',
        "circles[0].position[0]: must be a number, got 'nan'",
    ),
    'infinity': (
        'circles: [{position: [0, 0], radius: 1, mass: .inf}]\n',
        'circles[0].mass: must be finite, got .inf',
    ),
    'overflow': (
        'circles: [{position: [0, 1e999], radius: 1}]\n',
        'circles[0].position[1]: must be finite, got 1e999',
    ),
    'long_integer': (
        f'circles: [{{position: [0, 1{"0" * 5000}], radius: 1}}]\n',
        'circles[0].position[1]: must be finite, got '
        '100000000000000000000000000000000000000000000000000000000...',
    ),
    'zero_mass': (
        'circles: [{position: [0, 0], radius: 1, mass: 0}]\n',
        'circles[0].mass: must be > 0 kg, got 0',
    ),
    'one_coordinate': (
        'circles: [{position: [0], radius: 1}]\n',
        'circles[0].position: must be two numbers [x, y], got [0]',
    ),
    'three_coordinates': (
        'circles: [{position: [0, 0, 0], radius: 1}]\n',
        'circles[0].position: must be two numbers [x, y], got [0, 0, 0]',
    ),
    'position_a_mapping': (
        'circles: [{position: {x: 0, y: 0}, radius: 1}]\n',
        'circles[0].position: must be two numbers [x, y], got the keys x, y',
    ),
    'missing_coordinate': (
        'circles: [{position: [0, 0], radius: 1, velocity: [1, ~]}]\n',
        'circles[0].velocity[1]: must be a number, got nothing',
    ),
    'locked_yes': (
        'circles: [{position: [0, 0], radius: 1, locked: yes}]\n',
        "circles[0].locked: must be true or false, got 'yes'",
    ),
    'locked_but_moving': (
        'circles: [{position: [0, 0], velocity: [1, 0], radius: 1, locked: true}]\n',
        'circles[0].velocity: must be (0, 0) for a locked circle, got (1.0, 0.0)',
    ),
    'name_with_hyphen': (
        'circles: [{name: my-ball, position: [0, 0], radius: 1}]\n',
        'circles[0].name: must be a letter followed by letters, digits or single '
        "underscores, at most 100 characters, got 'my-ball'",
    ),
    'name_with_digit_first': (
        'circles: [{name: 8ball, position: [0, 0], radius: 1}]\n',
        'circles[0].name: must be a letter followed by letters, digits or single '
        "underscores, at most 100 characters, got '8ball'",
    ),
    'name_with_two_underscores': (
        'circles: [{name: a__b, position: [0, 0], radius: 1}]\n',
        'circles[0].name: must be a letter followed by letters, digits or single '
        "underscores, at most 100 characters, got 'a__b'",
    ),
    'name_not_ascii': (
        'circles: [{name: grün, position: [0, 0], radius: 1}]\n',
        'circles[0].name: must be a letter followed by letters, digits or single '
        "underscores, at most 100 characters, got 'grün'",
    ),
    'name_with_newline': (
        'circles: [{name: "a\\n", position: [0, 0], radius: 1}]\n',
        'circles[0].name: must be a letter followed by letters, digits or single '
        "underscores, got 'a\\n'",
    ),
    'name_a_number': (
        'circles: [{name: 8, position: [0, 0], radius: 1}]\n',
        'circles[0].name: must be a letter followed by letters, digits or single '
        'underscores, at most 100 characters, got 8',
    ),
    'name_too_long': (
        f'circles: [{{name: {"a" * 101}, position: [0, 0], radius: 1}}]\n',
        'circles[0].name: must be a letter followed by letters, digits or single '
        'underscores, at most 100 characters, got '
        "'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...",
    ),
    'duplicate_names': (
        'circles:\n'
        '- {name: ball, position: [0, 0], radius: 1}\n'
        '- {name: ball, position: [3, 0], radius: 1}\n',
        "circles[1].name: must be unique, got 'ball' as for circles[0]",
    ),
    'overlap': (
        'circles:\n'
        '- {name: green, position: [0, 0], radius: 1}\n'
        '- {name: red, position: [1.5, 0], radius: 1, locked: true}\n',
        'circles[0] (green) and circles[1] (red): must not overlap, got 0.5 m',
    ),
    'overlap_with_wall': (
        GOOD_CIRCLE
        + 'walls: [{start: [5, 5], end: [6, 6]}, {start: [-2, 0.75], end: [2, 0.75]}]\n',
        'circles[0] and walls[1]: must not overlap, got 0.25 m',
    ),
    'overlap_with_box': (
        GOOD_CIRCLE
        + 'walls: [{start: [5, 5], end: [6, 6]}, {box: {min: [-2, -2], max: [0.5, 2]}}]\n',
        'circles[0] and walls[1].box: must not overlap, got 0.5 m',
    ),
    'overlap_with_polygon': (
        GOOD_CIRCLE + 'walls: [{polygon: [[-2, -2], [0.5, -2], [0.5, 2], [-2, 2]]}]\n',
        'circles[0] and walls[0].polygon[1]: must not overlap, got 0.5 m',
    ),
    'wall_without_end': (
        GOOD_CIRCLE + 'walls: [{start: [5, 5]}]\n',
        'walls[0]: must have start and end, or box alone, or polygon alone, got the key start',
    ),
    'wall_of_two_kinds': (
        GOOD_CIRCLE + 'walls: [{start: [5, 5], box: {min: [-9, -9], max: [9, 9]}}]\n',
        'walls[0]: must have start and end, or box alone, or polygon alone, got the keys '
        'start, box',
    ),
    'wall_a_point': (
        GOOD_CIRCLE + 'walls: [{start: [5, 5], end: [5, 5]}]\n',
        'walls[0].end: must differ from start, got (5.0, 5.0) for both',
    ),
    'box_inside_out': (
        GOOD_CIRCLE + 'walls: [{box: {min: [-9, 9], max: [9, -9]}}]\n',
        'walls[0].box.max[1]: must be > min[1], which is 9 m, got -9',
    ),
    'box_without_max': (
        GOOD_CIRCLE + 'walls: [{box: {min: [-9, 9]}}]\n',
        'walls[0].box.max: must be given, got nothing',
    ),
    'polygon_of_two': (
        GOOD_CIRCLE + 'walls: [{polygon: [[5, 5], [6, 6]]}]\n',
        'walls[0].polygon: must be a list of at least 3 points, got [[5, 5], [6, 6]]',
    ),
    'polygon_closed_twice': (
        GOOD_CIRCLE + 'walls: [{polygon: [[5, 5], [6, 5], [6, 6], [5, 5]]}]\n',
        'walls[0].polygon[3]: must differ from the next point, got [5, 5] for both',
    ),
    'restart_at_once': (GOOD_CIRCLE + 'restart_after: 0\n', 'restart_after: must be > 0 s, got 0'),
    'restart_never': (
        GOOD_CIRCLE + 'restart_after: .inf\n',
        'restart_after: must be finite, got .inf',
    ),
    'collide_a_word': (
        GOOD_CIRCLE + 'moving_circles_collide: off\n',
        "moving_circles_collide: must be true or false, got 'off'",
    ),
    'seed_negative': (GOOD_CIRCLE + 'seed: -1\n', 'seed: must be >= 0, got -1'),
    'seed_fraction': (GOOD_CIRCLE + 'seed: 0.5\n', 'seed: must be a whole number, got 0.5'),
    'seed_too_large': (
        GOOD_CIRCLE + 'seed: 9223372036854775808\n',
        'seed: must be <= 9223372036854775807, got 9223372036854775808',
    ),
    'group_of_one_rule': (
        'groups: [{count: 3, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0]: must have exactly two of count, radius and packing, got the keys count, '
        'region',
    ),
    'group_of_three_rules': (
        'groups: [{count: 3, radius: 0.1, packing: 0.1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0]: must have exactly two of count, radius and packing, got the keys count, '
        'radius, packing, region',
    ),
    'group_without_region': (
        'groups: [{count: 3, radius: 0.1}]\n',
        'groups[0].region: must be given, got nothing',
    ),
    'group_of_none': (
        'groups: [{count: 0, radius: 0.1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].count: must be >= 1, got 0',
    ),
    'group_of_many': (
        'groups: [{count: 100001, radius: 0.1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].count: must be <= 100000, got 100001',
    ),
    'group_of_fractions': (
        'groups: [{count: 2.5, radius: 0.1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].count: must be a whole number, got 2.5',
    ),
    'group_that_cannot_fit': (
        'groups: [{count: 30, radius: 0.1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0]: must fit into its region without overlap, got room for 20 of 30 circles',
    ),
    'group_around_which_all_is_full': (
        'circles: [{position: [0.5, 0.5], radius: 0.5, locked: true}]\n'
        'groups: [{count: 5, radius: 0.08, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0]: must fit into its region without overlap, got room for 4 of 5 circles',
    ),
    'group_wider_than_its_region': (
        'groups: [{count: 1, radius: 1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0]: must fit into its region without overlap, got room for 0 of 1 circles',
    ),
    'group_of_less_than_one': (
        'groups: [{packing: 0.1, radius: 1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].radius: must be small enough for one circle, got 0.0318 of one',
    ),
    'group_of_too_small_ones': (
        'groups: [{packing: 0.1, radius: 1e-5, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].radius: must be large enough for at most 100000 circles, got 3.1831e+08',
    ),
    'group_too_dense': (
        'groups: [{packing: 0.91, count: 9, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].packing: must be < 0.9069, got 0.91',
    ),
    'group_of_no_region': (
        'groups: [{packing: 0.1, count: 9, region: {min: [0, 0], max: [0, 1]}}]\n',
        'groups[0].region.max[0]: must be > min[0], which is 0 m, got 0',
    ),
    'groups_of_too_many_in_all': (
        'circles: [{position: [2, 2], radius: 1}]\n'
        'groups: [{count: 100000, packing: 0.1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0]: must leave the scene with at most 100000 circles, got 100001',
    ),
    'too_many_groups': (
        'groups: [' + '1,' * 101 + ']\n',
        'groups: must be a list of at most 100 groups, got [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, '
        '1, 1, 1, 1, 1, 1, 1, 1,...',
    ),
    'group_of_a_narrow_region': (
        'groups: [{packing: 0.1, count: 9, region: {min: [0, 0], max: [1e-200, 1]}}]\n',
        'groups[0].region.max[0]: must be at least 1e-60 m above min[0], got 1e-200 m',
    ),
    'group_under_a_large_circle': (
        'circles: [{position: [0, 0], radius: 99, locked: true}]\n'
        'groups: [{count: 3, radius: 1e-4, region: {min: [0, 0], max: [50, 50]}}]\n',
        'groups[0]: must fit into its region without overlap, got room for 0 of 3 circles',
    ),
    'range_upside_down': (
        'groups: [{count: 3, radius: [0.2, 0.1], region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].radius[1]: must be >= radius[0], which is 0.2 m, got 0.1',
    ),
    'range_from_zero': (
        'groups: [{count: 3, radius: [0, 0.1], region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].radius[0]: must be > 0 m, got 0',
    ),
    'range_of_three': (
        'groups: [{count: 3, radius: [1, 2, 3], region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].radius: must be a number or [smallest, largest], got [1, 2, 3]',
    ),
    'speed_negative': (
        'groups: [{count: 3, radius: 0.1, speed: -1, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].speed: must be >= 0 m/s, got -1',
    ),
    'speed_a_word': (
        'groups: [{count: 3, radius: 0.1, speed: fast, region: {min: [0, 0], max: [1, 1]}}]\n',
        "groups[0].speed: must be a number or {maxwell: s}, got 'fast'",
    ),
    'speed_of_boltzmann': (
        'groups: [{count: 3, radius: 0.1, speed: {boltzmann: 1}, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].speed.boltzmann: must be one of the keys maxwell, got an unknown key',
    ),
    'maxwell_negative': (
        'groups: [{count: 3, radius: 0.1, speed: {maxwell: -1}, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].speed.maxwell: must be >= 0 m/s, got -1',
    ),
    'locked_group_with_speed': (
        'groups: [{count: 3, radius: 0.1, speed: 1, locked: true, region: {min: [0, 0], max: [1, 1]}}]\n',
        'groups[0].speed: must be 0 m/s for a locked group, got 1',
    ),
}
