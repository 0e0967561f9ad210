"""Templates: strict, sandboxed, with errors that name the line."""

from pathlib import Path

import pytest
from tests.installing import install

from beliefnest.errors import InputError, TemplateError
from beliefnest.prompts import (
    BUILT_IN,
    FilterSet,
    Renderer,
    Template,
    built_in_template,
    filter,
    filterset,
    load_template,
    render,
)
from beliefnest.prompts.example import example_branch
from beliefnest.prompts.reference import filter_reference


def show(template, filters=BUILT_IN, **variables):
    return render(template, example_branch(), variables, filters)


def test_an_unknown_filter_names_line_and_nearest():
    with pytest.raises(TemplateError, match=r"^mine, line 3: .*'chest'.*chests"):
        show(Template("mine", "a\nb\n{% if false %}{{ branch | chest }}{% endif %}"))


def test_an_unknown_variable_names_line_and_nearest():
    with pytest.raises(TemplateError, match=r"^template, line 2: 'tsk' is undefined.*task"):
        show("a\n{{ tsk }}", task="x")
    with pytest.raises(TemplateError, match=r"line 2: .*brnach.*branch"):
        show("a\n{{ brnach | chests }}")


def test_an_unknown_variable_may_be_asked_for():
    assert show("{{ 'yes' if x is defined else 'no' }}") == "no"


def test_an_unknown_test_is_refused():
    with pytest.raises(TemplateError, match=r"no test 'defned'.*defined"):
        show("{{ x is defned }}")


def test_a_template_that_was_filled_before_is_filled_anew_and_names_its_lines():
    renderer, branch = Renderer(BUILT_IN), example_branch()
    template = Template("mine", "a\n{{ 12 // task }}")
    texts = [renderer.render(template, branch, {"task": number}) for number in (3, 4)]
    assert texts == ["a\n4", "a\n3"]
    for _ in range(2):
        with pytest.raises(TemplateError, match=r"^mine, line 2: .*ZeroDivisionError"):
            renderer.render(template, branch, {"task": 0})
    with pytest.raises(TemplateError, match=r"line 2: 'task' is undefined"):
        renderer.render(template, branch, {})


def test_broken_source_names_the_line():
    with pytest.raises(TemplateError, match=r"line 2: "):
        show("a\n{{ branch | ")


def test_a_missing_file_is_named(tmp_path: Path):
    with pytest.raises(TemplateError, match=r"there is no template file .*gone\.txt"):
        show(tmp_path / "gone.txt")
    path = tmp_path / "binary.txt"
    path.write_bytes(b"\xff\xfe\xff")
    with pytest.raises(TemplateError, match="cannot be read"):
        load_template(path)


def test_a_fault_in_a_filter_is_raised_with_its_cause():
    @filter("broken")
    def broken(branch):
        return {}["nothing"]

    with pytest.raises(TemplateError, match=r"line 2: .*KeyError: 'nothing'") as caught:
        show("a\n{{ branch | broken }}", BUILT_IN.extended([broken]))
    assert isinstance(caught.value.__cause__, KeyError)


@pytest.mark.parametrize(
    "expression",
    [
        "branch.child('anne')",
        "branch.state.blocks.named([])",
        "branch.__class__",
        "''.__class__.__mro__",
        "branch.child.__func__.__globals__",
        "items.append(1)",
        "'{0.__class__}'.format(branch)",
    ],
)
def test_templates_read_and_do_not_act(expression):
    with pytest.raises(TemplateError, match="line 1"):
        show("{{ " + expression + " }}", items=[])


def test_what_a_template_prints_without_a_filter_has_lines_and_commands_nothing():
    said = [(1, "anne", "a\x1b[31m\u2028\u202eb\r")]
    assert show("{% for _, _, text in said %}{{ text }}{% endfor %}", said=said) == (
        r"a\u001b[31m\u2028\u202eb\u000d"
    )
    code = "if (a) {\n\tb('\u00e9\U0001f600')\n}\n"
    assert show("{{ code }}", code=code) == code


def test_templates_may_use_macros_ranges_and_methods_of_plain_values():
    source = "{% macro m(x) %}<{{ x }}>{% endmacro %}{{ m(1) }}{% for k, v in d.items() %}{{ k }}{% endfor %}{{ 'a'.upper() }}{{ range(2) | list }}"  # noqa: E501
    assert show(source, d={"k": 1}) == "<1>kA[0, 1]"


def test_last_code_and_error_are_texts_not_source():
    source = "$$LAST_CODE$$\n$$LAST_ERROR$$"
    assert show(source) == "No code was executed\nNo error"
    assert show(source, last_code=None, last_error=None) == "No code was executed\nNo error"
    assert show(source, last_code="f({{ x }})", last_error="") == "f({{ x }})\n"


def test_several_simulators_in_one_prompt():
    anne = example_branch().child("anne")
    assert show('{{ anne | position("anne") }} {{ branch | position }}', anne=anne) == (
        "[2.5, -51, -5.5] [-4.551, -51, -5.871]"
    )


def test_own_filters_are_added_and_replace_only_when_they_say_so():
    @filter("chests")
    def chests(branch, word="none"):
        return word

    with pytest.raises(InputError, match="override=True"):
        BUILT_IN.extended([chests])
    ours = BUILT_IN.extended([filter("chests", override=True)(chests.function)])
    assert show('{{ branch | chests("x") }}', ours) == "x"
    assert show("{{ branch | chests }}") != "none"
    assert chests(None) == "none"


def test_what_is_no_filter_is_refused():
    with pytest.raises(InputError, match="@filter"):
        FilterSet.of([len])
    with pytest.raises(InputError, match="letters"):
        filter("two words")


@filter("installed_greeting")
def installed_greeting(branch):
    return "Hi"


def test_an_installed_filter_that_is_none_is_named(tmp_path, monkeypatch):
    install(tmp_path, "bad-filters", "[beliefnest.filters]\nbad = json:dumps\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(InputError, match=r"'bad'.*@filter"):
        filterset.installed_filters(BUILT_IN)


def test_an_installed_filter_that_cannot_be_imported_stops_only_templates_that_call_it(
    tmp_path, monkeypatch
):
    install(tmp_path, "bad-filters", "[beliefnest.filters]\nbad = no_such_module:f\n")
    monkeypatch.syspath_prepend(tmp_path)
    filters = filterset.installed_filters(BUILT_IN)
    assert show("{{ branch.state.owner }}", filters) == "sally"
    message = r"line 1: .*the filter 'bad' of the installed package .*no_such_module"
    with pytest.raises(TemplateError, match=message):
        show("{{ branch | bad(1) }}", filters)


def test_installed_filters_are_found(tmp_path: Path, monkeypatch):
    (tmp_path / "bn_greeting.py").write_text(
        "from beliefnest.prompts import filter\n\n"
        "@filter('greeting')\ndef greeting(branch):\n    return 'Hi ' + branch.state.owner\n"
    )
    install(tmp_path, "bn-greeting", "[beliefnest.filters]\ngreeting = bn_greeting:greeting\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert show("{{ branch | greeting }}", filterset.installed_filters(BUILT_IN)) == "Hi sally"


def test_the_default_template_renders_with_and_without_extras():
    template = built_in_template("default")
    plain = show(template, task="Get a diamond.")
    assert plain.endswith("Task: Get a diamond.\n")
    assert "Places:" not in plain
    skill = {"signature": "think(bot, msg)", "description": "Think."}
    full = show(template, task="Go.", skills=[skill], places={"Home": (1, 2, 3)})
    helping = show(template, task="Help Sally.", tasks={"sally": "Get a diamond."})
    assert helping.endswith("\n\nsally's task: Get a diamond.\n\nTask: Help Sally.\n")
    assert "Places:\nHome is at (1, 2, 3)\n\nPosition:" in full
    assert "think(bot, msg)\n    Think.\n" in full
    with pytest.raises(TemplateError, match="'task' is undefined"):
        show(template)


def test_an_unknown_built_in_template_names_all():
    with pytest.raises(TemplateError, match=r"'papr'; there are .*paper"):
        built_in_template("papr")


def test_the_reference_in_the_docs_is_what_the_filters_do():
    page = Path(__file__).parents[2] / "docs" / "filters.md"
    assert page.read_text(encoding="utf-8") == filter_reference()


@pytest.mark.parametrize(
    "source",
    [
        "{{ 'x' * 10**10 }}",
        "{{ [1] * 10**9 }}",
        "{{ '%999999999d' % 1 }}",
        "{{ 9 ** (9 ** 9) }}",
        "{{ 'x'.ljust(10**9) }}",
        "{% set all = namespace(text='x' * 900000) %}{{ all.text + all.text }}",
        "{" * 100_000,
    ],
)
def test_a_value_without_end_is_refused(source):
    with pytest.raises(TemplateError, match=r"more than 1,000,000 parts|nested too deeply"):
        render(source, example_branch(), {})


def test_numbers_in_texts_are_no_widths():
    source = (
        "{{ 'seed 20260101, 90000000 %: %s %05.1f' % ('a', 2.5) }}{{ '%(n)s' % {'n': 9999999} }}"
    )
    with pytest.raises(TemplateError, match="ValueError"):
        render(source, example_branch(), {})
    right = source.replace("90000000 %:", "90000000 %%:")
    assert render(right, example_branch(), {}) == "seed 20260101, 90000000 %: a 002.59999999"


BOX = "{% set box = namespace(it='ab', row=[1]) %}"
KEYS = "{% set key = (1,) * 900000 %}{% set values = dict(range(99998) | batch(2)).values() %}"
LONG = "{% set long = [1] * 900000 %}"


@pytest.mark.parametrize(
    "source",
    [
        "{% for a in range(99999) %}{% for b in range(99999) %}{% endfor %}{% endfor %}",
        "{% for a in range(99999) %}{% for b in range(99999) if false %}{% endfor %}{% endfor %}",
        "{% macro f() %}{{ f() }}{{ f() }}{% endmacro %}{{ f() }}",
        "{% macro f(n) %}{% if n %}{{ f(n - 1) ~ f(n - 1) }}{% endif %}{% endmacro %}{{ f(60) }}",
        *(
            f"{BOX}{{% for i in range(99) %}}{{% set box.it = {twice} %}}{{% endfor %}}"
            for twice in (
                "box.it ~ box.it",
                "box.it + box.it",
                "box.it | replace('a', box.it)",
                "box.it.replace('a', box.it)",
                "[box.it, box.it] | join",
                "box.it.join([box.it, box.it])",
                "'%s%s' | format(box.it, box.it)",
                "'%s%s' % (box.it, box.it)",
                "[box.it, box.it]",
                "{1: box.it, 2: box.it}",
            )
        ),
        "{% set n = namespace(x=7) %}{% for i in range(99) %}{% set n.x = n.x * n.x %}{% endfor %}",
        "{% set it = 'ab' %}" + "{% set it %}{{ it }}{{ it }}{% endset %}" * 60,
        "{% for a in range(99999) %}" + "text " * 1000 + "{% endfor %}",
        "{% filter upper %}{% for a in range(99999) %}"
        + "text " * 999
        + "{% endfor %}{% endfilter %}",
        "{{ 'x' | center(999999999) }}",
        "{{ '%999999999d' | format(1) }}",
        "{{ '%*d' | format(999999999, 1) }}",
        "{{ '%*d' % (999999999, 1) }}",
        "{{ 'x' | indent(999999999, true) }}",
        "{{ ('x\n' * 100000) | indent(900000) }}",
        "{{ ('x' * 900000) | wordwrap(1) }}",
        "{{ ([[1]] * 900000) | sum(start=[]) }}",
        "{{ [1] | batch(999999999, 0) | list }}",
        "{{ 1 | round(999999999, 'floor') }}",
        "{{ ('\t' * 100000).expandtabs(100000) }}",
        "{{ range(99999) | join('x' * 100000) }}",
        "{{ range(99999) | map('center', 99999) | list }}",
        "{{ ['x' * 900000] * 900000 }}",
        f"{LONG}{{% for i in range(99999) %}}{{% if 2 in long %}}{{% endif %}}{{% endfor %}}",
        f"{LONG}{{% for i in range(99999) %}}{{% set some = long[::-1] %}}{{% endfor %}}",
        *(
            f"{KEYS}{{% for i in range(99999) %}}{{% set found = {look} %}}{{% endfor %}}"
            for look in ("key in {}", "{}[key] is defined", "key in {key: 1}", "0.5 in values")
        ),
        "{% for i in range(99999) %}{% set told = branch | story %}{% endfor %}",
    ],
)
def test_a_template_without_end_is_refused(source, monkeypatch):
    monkeypatch.setattr("beliefnest.prompts.bounds._MOST_STEPS", 1_000_000)
    with pytest.raises(TemplateError, match=r"^mine, line \d+: .*(steps|parts|nested too deeply)"):
        show(Template("mine", source))


def test_templates_include_no_files() -> None:
    with pytest.raises(
        TemplateError, match=r"no template '/etc/passwd' to include; .* built-in answering, "
    ):
        show(Template("mine", "{% include '/etc/passwd' %}"))


def test_each_rendering_has_its_own_bound():
    renderer = Renderer(BUILT_IN)
    source = "{% for i in range(99999) %}{{ 'many words' }}{% endfor %}"
    for _ in range(9):
        assert len(renderer.render(source, example_branch(), {})) == 999_990


def test_bounded_templates_are_filled_as_by_jinja():
    source = (
        "{% for a, b in {'x': 1}.items() %}{{ a ~ b ~ 'z' }} {{ loop.length }}{% endfor %}"
        "{% for a in [1, 2, 3] | select('odd') %}{{ loop.index }}/{{ loop.length }} {% endfor %}"
        "{% for a in [] %}{% else %}none {% endfor %}{{ (1, 2)[:1] }}{{ [1] + [2] }}"
        "{{ 'a,b'.split(',') | join('-') | center(5) }}{{ '%05.1f%%' | format(2.5) }}"
        "{{ ('a b ' * 90000) | wordwrap(79) | length }}{{ ([1] * 200000) | sum }} "
        "{{ {'a': [1]} | tojson }}{{ 7 // 2 - 1 }}{{ 'a' in ('a', 'b') }}{{ 'x' is in ['x'] }}"
        "{% for a in ['x'] %}{{ a in {'x': 1}.values() }}{{ {'x': 1}[a] < 2 }}{% endfor %}"
    )
    expected = 'x1z 11/2 2/2 none (1,)[1, 2] a-b 002.5%359999200000 {"a": [1]}2TrueTrueFalseTrue'
    assert render(source, example_branch(), {}) == expected
