"""The registry of blocks and items, as built from minecraft-data."""

import pytest

from beliefnest.errors import BodyError, InputError, UnknownNameError
from beliefnest.world.registry import AIR, Registry

# State ids below are those of Minecraft 1.20.4's own block report.


@pytest.fixture(scope="module")
def registry():
    return Registry.load()


def test_ids_of_well_known_states(registry):
    assert registry.state_id("air") == AIR == registry.air
    assert registry.state_id("stone") == 1
    assert registry.state_id("grass_block[snowy=true]") == 8
    assert registry.state_id("grass_block") == 9


def test_every_state_survives_a_round_trip(registry):
    for state_id in range(registry.states):
        assert registry.state_id(registry.text(state_id)) == state_id


def test_missing_properties_take_the_default_state_s_value(registry):
    assert registry.text(registry.state_id("oak_slab[type=top]")) == (
        "oak_slab[type=top,waterlogged=false]"
    )
    assert registry.properties(registry.state_id("chest")) == {
        "facing": "north",
        "type": "single",
        "waterlogged": "false",
    }


def test_text_sorts_properties_whatever_the_order_given(registry):
    text = "minecraft:oak_door[powered=false, open=true ,half=upper]"
    assert registry.text(registry.state_id(text)) == (
        "oak_door[facing=north,half=upper,hinge=left,open=true,powered=false]"
    )


def test_name_and_state_ids_agree(registry):
    for state_id in registry.state_ids("minecraft:oak_stairs"):
        assert registry.name(state_id) == "oak_stairs"
    assert registry.name(registry.state_ids("oak_stairs")[-1] + 1) != "oak_stairs"
    assert len(registry.state_ids("oak_stairs")) == 80


def test_boxes(registry):
    assert registry.boxes(registry.state_id("stone")) == ((0, 0, 0, 1, 1, 1),)
    assert registry.boxes(registry.state_id("oak_slab[type=top]")) == ((0, 0.5, 0, 1, 1, 1),)
    assert registry.boxes(registry.state_id("oak_slab[type=bottom]")) == ((0, 0, 0, 1, 0.5, 1),)
    assert registry.boxes(registry.state_id("oak_fence")) == ((0.375, 0, 0.375, 0.625, 1.5, 0.625),)
    assert registry.boxes(registry.state_id("lever")) == ()


def test_boxes_lie_on_a_grid_of_32nds_and_reach_out_along_one_axis_at_most(registry):
    for x0, y0, z0, x1, y1, z1 in registry.shape_boxes.tolist():
        assert x0 < x1 and y0 < y1 and z0 < z1
        out = [low < 0 or high > 1 for low, high in ((x0, x1), (y0, y1), (z0, z1))]
        assert sum(out) <= 1
    # The kernel of sight relies on both.
    assert ((registry.shape_boxes * 32) % 1 == 0).all()


@pytest.mark.parametrize(
    "text",
    [
        "glass",
        "tinted_glass",
        "red_stained_glass",
        "glass_pane[north=true]",
        "red_stained_glass_pane[east=true]",
        "barrier",
        "ice",
        "water",
        "lever",
        "oak_fence_gate[open=true]",
        "snow[layers=1]",
    ],
)
def test_transparent_by_default(registry, text):
    assert registry.default_transparent[registry.state_id(text)]


@pytest.mark.parametrize(
    "text",
    ["stone", "oak_leaves", "oak_slab", "chest", "packed_ice", "iron_bars", "snow[layers=2]"],
)
def test_opaque_by_default(registry, text):
    assert not registry.default_transparent[registry.state_id(text)]


def test_containers_and_items(registry):
    assert registry.is_container("minecraft:chest")
    assert registry.is_container("smoker")
    assert not registry.is_container("stone")
    assert registry.has_block("chest") and not registry.has_block("diamond")
    assert registry.has_item("diamond") and registry.has_item("minecraft:diamond")
    assert (registry.item_stack("diamond"), registry.item_stack("ender_pearl")) == (64, 16)


def test_a_misspelled_block_names_its_neighbours(registry):
    with pytest.raises(UnknownNameError, match=r"did you mean .*oak_slab"):
        registry.state_id("oak_slap")


def test_a_wrong_property_or_value_names_the_right_ones(registry):
    with pytest.raises(UnknownNameError, match="type, waterlogged"):
        registry.state_id("oak_slab[typ=top]")
    with pytest.raises(UnknownNameError, match="top, bottom, double"):
        registry.state_id("oak_slab[type=middle]")
    with pytest.raises(UnknownNameError, match="it has none"):
        registry.state_id("stone[type=top]")


@pytest.mark.parametrize("text", ["", "oak slab", "oak_slab[type]", "oak_slab[type=top", "a[b=c]d"])
def test_malformed_texts(registry, text):
    with pytest.raises(InputError):
        registry.state_id(text)


def test_a_property_given_twice_is_refused(registry):
    with pytest.raises(InputError, match="twice"):
        registry.state_id("oak_slab[type=top,type=bottom]")


def test_unknown_items_and_states(registry):
    with pytest.raises(UnknownNameError, match="diamond"):
        registry.item_stack("diamont")
    for state_id in (-1, registry.states):
        with pytest.raises(UnknownNameError, match="no block state"):
            registry.text(state_id)


def test_a_version_that_was_not_built_says_what_to_do():
    with pytest.raises(BodyError, match="pip install"):
        Registry.load("1.8.9")


def test_load_is_cached_and_tables_are_read_only(registry):
    assert Registry.load() is registry
    with pytest.raises(ValueError, match="read-only"):
        registry.default_transparent[0] = False
