"""Options that a sentence names, by text or by letter, and those that it rules out."""

import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import msgspec

_LONGEST = 1000
"""Greatest number of words of a sentence. Longer ones tell nothing clearly."""
_QUOTES = str.maketrans(
    {**dict.fromkeys("\u2018\u2019\u201a\u201b\u2032\u00b4", "'")}
    | dict.fromkeys("\u201c\u201d\u201e\u201f\u2033\u00ab\u00bb\u2039\u203a", '"')
    | dict.fromkeys("\u2010\u2011\u2212", "-")
    | dict.fromkeys("\u2192\u21d2\u279c\u279d\u27a4\u25b6\u27f6", ">")
    | dict.fromkeys("\u200b\u200c\u200d\u2060\ufeff\u00ad\ufe0f", None)
)
_MARKUP = (
    (re.compile(r"~~[^~\n]+~~"), " "),
    (re.compile(r"\\(?:text|textbf|textit|mathrm|mathbf|mathit|emph|textsf|texttt)\s*\{"), "{"),
    (re.compile(r"\\[()\[\]]|\$|\\boxed|\\[,;! ]|\\quad"), " "),
    (
        re.compile(
            r"</?(?:b|i|em|strong|u|mark|code|p|br|span|div|h[1-6]|li|ul|ol)\b[^<>]{0,80}>",
            re.IGNORECASE,
        ),
        " ",
    ),
    (re.compile(r"!?\[([^\[\]\n]{2,80})\]\([^()\n]{0,200}\)"), r"\1"),
    (re.compile(r"[*`_{}|]+"), " "),
    (re.compile(r"(?<=\w)-(?=\w)"), " "),
)
_CONTRACTIONS = (
    (re.compile(r"\bcan'?t\b|\bcannot\b", re.IGNORECASE), "can not"),
    (re.compile(r"\bwon't\b", re.IGNORECASE), "will not"),
    (re.compile(r"n't\b", re.IGNORECASE), " not"),
    (re.compile(r"\b(it|he|she|that|there|where|answer|what)'s\b", re.IGNORECASE), r"\1 is"),
    (re.compile(r"\b(i|you|he|she|we|they|it)'ll\b", re.IGNORECASE), r"\1 will"),
    (re.compile(r"\b(i|you|he|she|we|they|it)'d\b", re.IGNORECASE), r"\1 would"),
    (re.compile(r"\bi'm\b", re.IGNORECASE), "i am"),
)
_WORD = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)*|[^\W_]+(?:'[^\W_]+)*|[^\w\s]|\n")


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_ARTICLES = frozenset(["a", "an", "the"])
_PREPOSITIONS = _words("in at on inside into to within onto under near by of")
_FILL = (
    _ARTICLES
    | _PREPOSITIONS
    | _words(
        "it is was be are will would should must there that this he she they his her their its my "
        "your i say choose pick select option choice answer letter number both either and or "
        "nor neither first one box's just only simply still probably perhaps maybe most likely "
        "definitely certainly surely again now then look looks search searches go goes think "
        "thinks believe believes for with look's therefore so thus hence correct final"
    )
)
"""Words beside which an option's name still is the whole statement."""
_CONTRAST = frozenset(["not", "but", "rather", "than", "instead", "definitely", "certainly"])
_NEGATORS = _words("not never nor neither without except excluding eliminate doubt")
_BREAKS = _words("but so hence therefore thus because since yet whereas")
_REASONS = _words(
    "because since as although though while whereas despite when after before unaware until "
    "having where"
)
"""Words after which a sentence gives grounds and no answer."""
_ABOUT = frozenset(["from", "about", "unlike", "considering", "regarding", "considered"])
"""Words whose object is no answer."""
_MANIFOLD = frozenset(["left", "right", "last", "kind", "mean"])
"""Words that tell things apart and have other meanings."""
_CONDITIONS = frozenset(["if", "unless", "whether", "suppose", "supposing"])
_ABROAD = _words("vielleicht oder ou peut être quizás quizá forse talvez 也许 或 或者")
"""Words for `maybe` and `or` that models use in English answers, too."""
_EXCLUDES = _words("rule ruling exclude excluding dismiss")
_LABEL_BEFORE = (
    _ABROAD
    | _EXCLUDES
    | _words(
        "option choice answer letter is be choose pick select chose picked say and or not but so "
        "than of with go either both neither nor between thus therefore number would will maybe "
        "perhaps also otherwise else sometimes then first though although while see for out up "
        "case it"
    )
)
_LABEL_NOUNS = frozenset(["option", "choice", "letter", "number", "answer"])
_LABEL_AFTER = _ABROAD | _words(
    "and or but not nor because since as is are instead rather seems would makes fits for maybe "
    "perhaps also otherwise sometimes then though although unless if can could might may too"
)
_HEDGES = _ABROAD | _words(
    "maybe perhaps possibly alternatively otherwise else might could may sometimes second runner"
)
"""Words that name an alternative, also in brackets and after `although`."""
_CONCESSIONS = _words(
    "although though while but also still well less unless else or yet best guess bet candidate "
    "see argue consider some one case made up out can not"
)
_OPEN = re.compile(
    r"(?:also |too )?(?:(?:is|are|seems|remains|stays) (?:(?:also|still|just|equally|as|quite|a"
    r"|another|very|not) )*"
    r"(?:possible|plausible|conceivable|likely|possibility|(?:close |near )?second|impossible)"
    r"|(?:is|can|could) (?:not |also )*be (?:excluded|ruled out|dismissed)"
    r"|(?:might|could|may) (?:(?:also|well|still|just as) )*be\b(?! (?:where|what|why))"
    r"|possibly|otherwise|as well\b)"
)
"""Words after the name of an option that leave it open."""
_WRONG = _words("wrong incorrect false out eliminated impossible not never")
_SPEECH = _words(
    "will would is are looks look searches search thinks think believes believe goes go checks "
    "check opens open expects expect says say choose pick select going answers answer"
)
_PAST = _words(
    "put puts moved moves move placed places hid hides left leaves saw sees took takes was were "
    "had has asked asks asking considered mentions mentioned said"
)


class Token(msgspec.Struct, frozen=True):
    """Word or punctuation mark of a sentence.

    Attributes:
        raw: As written.
        word: In lower case; empty for punctuation.
    """

    raw: str
    word: str


@dataclass(slots=True)
class NamedOptions:
    """Options that a text names.

    Attributes:
        yes: Numbers of options that it names.
        no: Numbers of options that it rules out.
        unsure: Numbers of options that it names, perhaps to rule them out.
        aside: Numbers of options that it names in grounds or conditions.
        maybe: Numbers of the options in `yes` that it names as alternatives: `perhaps B`.
        either: Numbers of options in `aside` that hold under a condition: `unless ..., then B`.
        bare: True if the text holds nothing but names of options.
        told: True if the text states where or what, rather than what happened.
    """

    yes: set[int] = field(default_factory=set)
    no: set[int] = field(default_factory=set)
    unsure: set[int] = field(default_factory=set)
    aside: set[int] = field(default_factory=set)
    maybe: set[int] = field(default_factory=set)
    either: set[int] = field(default_factory=set)
    bare: bool = False
    told: bool = False

    @property
    def any(self) -> set[int]:
        """Numbers of all options in it."""
        return self.yes | self.no | self.unsure | self.aside


def plain_words(text: str) -> str:
    """Return a text with plain quotes, spaces and letters, and without emphasis and markup."""
    text = unicodedata.normalize("NFKC", text.translate(_QUOTES)).translate(_QUOTES)
    for pattern, by in (*_MARKUP, *_CONTRACTIONS):
        text = pattern.sub(by, text)
    return text


def tokens_of(plain: str) -> list[Token]:
    """Return the words and punctuation marks of a plain text."""
    return [
        Token(each, each.casefold() if each[-1].isalnum() else "") for each in _WORD.findall(plain)
    ]


def sentences(plain: str) -> list[str]:
    """Split a plain text at ends of sentences and lines; `A.` and `1.` end none."""
    parts = re.split(r"(?:(?<=[^\s(\[]{2}[.!?])|(?<=[.!?][\"')\]]))\s+|\n+", plain)
    return [each.strip() for each in parts if each.strip()]


def _stem(word: str) -> str:
    """Return a word without the ending of plurals."""
    if len(word) > 3 and word.endswith(("xes", "ches", "shes", "sses", "zes")):
        return word[:-2]
    if len(word) > 4 and word.endswith("ies"):
        return f"{word[:-3]}y"
    return word[:-1] if len(word) > 3 and word.endswith("s") and word[-2] not in "sui" else word


class _Mention(msgspec.Struct, frozen=True):
    options: frozenset[int]
    start: int
    end: int


class Names:
    """Names of some options: their texts, their letters or numbers, and short forms.

    Args:
        options: Texts of the options; those with letters or numbers of their own are labelled so.
        lettered: True if an option can be named by its letter.
    """

    def __init__(self, options: Sequence[str], *, lettered: bool = True) -> None:
        self._strict = lettered
        texts = [plain_words(each).strip() for each in options]
        own = [re.match(r"\(?([A-Za-z]|\d{1,2})[.):]\s+(?=\S)", each) for each in texts]
        numbered = (
            lettered and len(options) > 1 and all(own) and len({o[1] for o in own if o}) == len(own)
        )
        if numbered:
            self._labels = [each[1].upper() for each in own if each]
            texts = [text[each.end() :] for text, each in zip(texts, own, strict=True) if each]
        else:
            letters = [chr(ord("A") + number) for number in range(min(26, len(texts)))]
            self._labels = letters if lettered else []
        tokens = [[t for t in tokens_of(each) if t.raw != "\n"] for each in texts]
        while any(each and not each[-1].word and each[-1].raw in ".,;:!?" for each in tokens):
            tokens = [
                each[:-1] if each and not each[-1].word and each[-1].raw in ".,;:!?" else each
                for each in tokens
            ]
        self._raw = tokens
        self._stemmed, self._forms = self._distinct(tokens)
        self._weak = self._modifiers()

    def _distinct(self, tokens: list[list[Token]]) -> tuple[bool, list[tuple[str, ...]]]:
        """Return the shortest forms of all options that tell them apart."""
        forms: list[tuple[str, ...]] = []
        for stemmed, bare in ((True, True), (True, False), (False, False)):
            forms = [_core(each, stemmed=stemmed, bare=bare) for each in tokens]
            words = [tuple(w for w in form if w[-1].isalnum()) for form in forms]
            if len(set(words)) == len(words):
                return stemmed, forms
        return False, forms

    def _modifiers(self) -> dict[tuple[str, ...], int]:
        """Return names without the last word, if it is that of another option too: `red`."""
        lasts = [form[-1] for form in self._forms if form]
        options_of: dict[tuple[str, ...], list[int]] = {}
        for number, form in enumerate(self._forms):
            if 1 < len(form) < 4 and lasts.count(form[-1]) > 1:
                options_of.setdefault(form[:-1], []).append(number)
        return {form: own[0] for form, own in options_of.items() if len(own) == 1}

    def named(self, sentence: str) -> NamedOptions:
        """Return the options that a plain sentence names."""
        tokens = [token for token in tokens_of(sentence) if token.raw != "\n"]
        named = NamedOptions()
        if len(tokens) > _LONGEST:
            for each in self._mentions(tokens[:_LONGEST]):
                named.unsure |= each.options
            return named
        mentions = self._mentions(tokens)
        inside = {place: each for each in mentions for place in range(each.start, each.end)}
        words = [t.word for t in tokens]
        outside = [w if place not in inside else "" for place, w in enumerate(words)]
        supposed = not _CONDITIONS.isdisjoint(outside)
        named.bare = bool(mentions) and all(
            place in inside or not word or _is_fill(word) for place, word in enumerate(words)
        )
        grounds = _grounds(tokens, inside)
        sides = _sides(tokens, inside) if supposed else {}
        answers = [each for each in mentions if sides.get(each.start) == "answer"]
        for each in answers:
            named.either |= each.options if not _negated(tokens, inside, each) else set()
        # `A unless he saw it` is an answer with a doubt; `if he saw it, A` is half of one.
        sole = len(named.either) == 1 and _CONDITIONS.isdisjoint({*outside} - {"unless"})
        for each in mentions:
            open_ = not supposed and _is_left_open(tokens, inside, each)
            conditional = supposed and not (sole and each in answers)
            conditional |= "otherwise" in outside[: each.start]
            if not open_ and (conditional or (each.start in grounds and not named.bare)):
                named.aside |= each.options
                continue
            match _negated(tokens, inside, each):
                case True:
                    named.no |= each.options
                case None:
                    named.unsure |= each.options
                case False:
                    named.yes |= each.options
                    named.maybe |= each.options if open_ else set()
                    clause = _clause_before(tokens, each.start)
                    stated = any(w in _SPEECH for w in clause)
                    named.told |= stated and not any(w in _PAST for w in clause)
        named.told |= named.bare
        return named

    def without(self, sentence: str) -> str:
        """Return a plain sentence in lower case without the names in it."""
        tokens = [token for token in tokens_of(sentence) if token.raw != "\n"]
        inside = {p for each in self._mentions(tokens) for p in range(each.start, each.end)}
        return " ".join(t.word or t.raw for p, t in enumerate(tokens) if p not in inside)

    def label_first(self, sentence: str) -> tuple[int, str] | None:
        """Return the option of a leading letter such as `B)` or `(B)`, and the rest; None: none."""
        match = re.match(r"\W*?[(\[]?([A-Za-z]|\d{1,2})\s*(?:[)\].:,]|-(?=\s))+\s*(?=\S)", sentence)
        if match is None or match[1].upper() not in self._labels:
            return None
        if match[1].islower() and not re.match(r"\W*[a-z]\s*[).:]", sentence):
            return None
        return self._labels.index(match[1].upper()), sentence[match.end() :]

    def _mentions(self, tokens: Sequence[Token]) -> list[_Mention]:
        spans: dict[tuple[int, int], set[int]] = {}
        for number, form in enumerate(self._forms):
            if len(form) == 1 and len(form[0]) == 1 and form[0].isascii() and form[0].isalpha():
                continue
            for start in range(len(tokens)):
                end = self._match(tokens, start, form)
                if end is not None:
                    spans.setdefault((start, end), set()).add(number)
        chosen: list[_Mention] = []
        taken: set[int] = set()
        for (start, end), own in sorted(
            spans.items(), key=lambda each: (each[0][0] - each[0][1], each[0][0])
        ):
            if not taken & set(range(start, end)) and not (
                self._strict and (_is_modified(tokens, start, end) or _goes_on(tokens, start, end))
            ):
                taken |= set(range(start, end))
                chosen.append(_Mention(frozenset(own), start, end))
        chosen += self._short(tokens, taken)
        chosen += self._letters(tokens, taken)
        return sorted(chosen, key=lambda each: each.start)

    def _match(self, tokens: Sequence[Token], start: int, form: Sequence[str]) -> int | None:
        if not form or (tokens[start].word in _ARTICLES and form[0] not in _ARTICLES):
            return None
        at = start
        for wanted in form:
            if not wanted[-1].isalnum():
                at += at < len(tokens) and tokens[at].raw == wanted
                continue
            while (
                at > start
                and at < len(tokens)
                and tokens[at].word in _ARTICLES
                and wanted not in _ARTICLES
            ):
                at += 1
            word = tokens[at].word if at < len(tokens) else None
            if word is None or (_stem(word) if self._stemmed else word) != wanted:
                return None
            at += 1
        return at

    def _short(self, tokens: Sequence[Token], taken: set[int]) -> Iterator[_Mention]:
        """Yield mentions of options by what tells them apart: `blue`, `the blue one`."""
        shorts = {word for form in self._weak for word in form}
        for form, number in self._weak.items():
            for start in range(len(tokens)):
                end = self._match(tokens, start, form)
                if end is None or taken & set(range(start, end)):
                    continue
                before = tokens[start - 1] if start else None
                after = tokens[end] if end < len(tokens) else None
                one = after is not None and after.word in ("one", "ones")
                ends = after is None or not after.word or after.word in _LABEL_AFTER
                the = before is not None and before.word == "the"
                # `He left` and `that is right` name neither box.
                fill = _ARTICLES | _PREPOSITIONS if set(form) & _MANIFOLD else _FILL
                alone = all(
                    t.word in fill or not t.word or t.word in shorts or t.word in _CONTRAST
                    for place, t in enumerate(tokens)
                    if not start <= place < end + one and place not in taken
                )
                if (the and (one or ends)) or (alone and (one or ends)):
                    taken |= set(range(start, end + one))
                    yield _Mention(frozenset([number]), start, end + one)

    def _letters(self, tokens: Sequence[Token], taken: set[int]) -> Iterator[_Mention]:
        words = [place for place, token in enumerate(tokens) if token.word]
        for place in words:
            token = tokens[place]
            if place in taken or token.raw.upper() not in self._labels:
                continue
            alone = words == [place]
            if not alone and not _is_label(tokens, place):
                continue
            own = {self._labels.index(token.raw.upper())}
            for number, raw in enumerate(self._raw):
                names_it = any(t.raw == token.raw.upper() for t in raw)
                starts_so = len(raw) > 1 and raw[0].raw == token.raw.upper() == "A"
                own |= {number} if names_it and not starts_so else set()
            yield _Mention(frozenset(own), place, place + 1)


def _is_fill(word: str) -> bool:
    return word in _FILL or word in _CONTRAST or word.endswith("'s")


def _clause_before(tokens: Sequence[Token], end: int) -> list[str]:
    """Return the words of a clause before a place."""
    words: list[str] = []
    for token in reversed(tokens[:end]):
        if token.raw in ",;:." or token.word in _BREAKS:
            break
        if token.word:
            words.append(token.word)
    return words


def _core(tokens: Sequence[Token], *, stemmed: bool, bare: bool) -> tuple[str, ...]:
    """Return the words and marks of an option that a mention must repeat."""
    kept = list(tokens)
    if bare:
        while len(kept) > 1 and kept[0].word in _PREPOSITIONS | _ARTICLES:
            kept = kept[1:]
        kept = [t for t in kept if t.word not in _ARTICLES] or list(tokens)
    while len(kept) > 1 and not kept[0].word and kept[0].raw not in "(":
        kept = kept[1:]
    forms = [(_stem(t.word) if stemmed else t.word) or t.raw for t in kept]
    # Words only at both ends; a number in brackets keeps its marks inside.
    while len(forms) > 1 and not forms[0][-1].isalnum():
        forms = forms[1:]
    while len(forms) > 1 and not forms[-1][-1].isalnum():
        forms = forms[:-1]
    return tuple(forms)


def _is_modified(tokens: Sequence[Token], start: int, end: int) -> bool:
    """Return True if another word makes something else of a name: `big box`, `box lid`."""

    def free(place: int) -> bool:
        return 0 <= place < len(tokens) and bool(tokens[place].word)

    def plain(place: int) -> bool:
        word = tokens[place].word
        return word in _FILL or word in _KNOWN or word.endswith(("ly", "'s"))

    if free(start - 1) and not plain(start - 1):
        two = start - 2
        if two < 0 or not tokens[two].word or tokens[two].word in _ARTICLES | _PREPOSITIONS:
            return tokens[start - 1].word not in _KNOWN
    if free(end) and not plain(end):
        closed = end + 1 >= len(tokens) or not tokens[end + 1].word
        led = not free(start - 1) or tokens[start - 1].word in _ARTICLES | _PREPOSITIONS
        return closed and led
    return False


def _goes_on(tokens: Sequence[Token], start: int, end: int) -> bool:
    """Return True if a clause such as `he does not know` goes on: `... that Anne moved it`."""
    words = {token.word for token in tokens[start:end]}
    if not words & {"not", "he", "she", "they", "i", "know", "knows", "nobody"}:
        return False
    if end >= len(tokens):
        return False
    following = tokens[end]
    return following.word in ("it", "that", "whether", "if", "the", "a", "an") or (
        following.word != "" and following.raw[0].isupper() and following.raw[1:].islower()
    )


_KNOWN = (
    _NEGATORS
    | _HEDGES
    | _BREAKS
    | _REASONS
    | _CONDITIONS
    | _WRONG
    | _SPEECH
    | _PAST
    | _words(
        "than from rather instead actually correction wait sorry no yes well ok okay mean it's "
        "first today too as who which not anywhere nowhere elsewhere cause due given however means "
        "stays remains what how why can could may might does do did"
    )
)


def _is_label(tokens: Sequence[Token], place: int) -> bool:  # noqa: PLR0911 - a rule each
    """Return True if a single letter or number stands for an option, and is no word."""
    token = tokens[place]
    before = tokens[place - 1] if place else None
    after = tokens[place + 1] if place + 1 < len(tokens) else None
    if before is not None and after is not None and before.raw in "([" and after.raw in ")]":
        return True
    if before is not None and before.word in _LABEL_NOUNS:
        ends = after is None or (not after.word and after.raw != "'")
        return token.raw.isupper() or token.raw.isdigit() or ends
    if not (token.raw.isupper() or token.raw.isdigit()):
        return place == 0 and after is not None and after.raw in ").:"
    if token.raw == "I":
        return False
    if (
        before is not None
        and before.word
        and not (before.word in _LABEL_BEFORE or before.word.endswith("ly"))
    ):
        return False
    if token.raw.isdigit():
        return place == 0 and after is not None and after.raw in ").:"
    at = place + 1
    while at < len(tokens) and tokens[at].word.endswith(("first", "most", "ly")):
        at += 1
    return at >= len(tokens) or not tokens[at].word or tokens[at].word in _LABEL_AFTER


def _is_left_open(tokens: Sequence[Token], inside: dict[int, _Mention], mention: _Mention) -> bool:
    """Return True if a mention names an alternative: `maybe B`, `B is possible too`."""
    after = " ".join(t.word or t.raw for t in tokens[mention.end : mention.end + 8])
    if _OPEN.match(after) and "impossible" not in after:
        return True
    hedged = False
    said: set[str] = set()
    for place in range(mention.start - 1, -1, -1):
        word = tokens[place].word
        if place in inside or not (word or tokens[place].raw == ":"):
            break
        hedged = hedged or word in _HEDGES or (word == "not" and bool(said & _EXCLUDES))
        said.add(word)
        if (
            word
            and word not in _FILL | _HEDGES | _CONCESSIONS | _EXCLUDES
            and not word.endswith("ly")
        ):
            return False
    return hedged


def _grounds(tokens: Sequence[Token], inside: dict[int, _Mention]) -> set[int]:
    """Return the places of tokens that give grounds: after `because`, `from`, or in brackets."""
    places: set[int] = set()
    depth, reason = 0, False
    answered = False
    for place, token in enumerate(tokens):
        if place in inside:
            answered = answered or not (reason or depth)
        elif token.raw in "([":
            depth += not _closes_on_name(tokens, place, inside)
        elif token.raw in ")]":
            depth = max(0, depth - 1)
        elif token.raw in ".;:!?":
            reason = False
        elif token.raw == ",":
            # After the answer, grounds go on to the end of the sentence.
            reason = reason and answered
        elif token.word in _REASONS:
            reason = True
        elif token.word in ("or", "perhaps", "maybe", "possibly", "alternatively"):
            reason = False
        if depth or reason:
            places.add(place)
        if place not in inside and token.word in _ABOUT:
            following = next((p for p in range(place, len(tokens)) if p in inside), None)
            if following is not None and following - place < 4:
                places.add(following)
    return places


def _sides(tokens: Sequence[Token], inside: dict[int, _Mention]) -> dict[int, str]:
    """Return for the tokens of a sentence with a condition what they belong to.

    It is an `answer`, the `condition` of one, or what would be if something `else` were so.
    """
    sides: dict[int, str] = {}
    side = "answer"
    for place, token in enumerate(tokens):
        if place in inside:
            pass
        elif token.word in ("because", "since", "as"):
            side = "else"
        elif token.word in _CONDITIONS:
            side = "condition" if side != "else" else side
        elif side == "condition" and token.word in ("had", "were"):
            side = "else"
        elif token.raw in ".;/" or token.word in ("otherwise", "else"):
            side = "answer"
        elif token.raw in ",:)\u2014" or token.word in ("then", "which"):
            side = "answer" if side == "condition" else side
        sides[place] = side
    return sides


def _closes_on_name(tokens: Sequence[Token], place: int, inside: dict[int, _Mention]) -> bool:
    """Return True if brackets hold nothing but the name of an option."""
    for at in range(place + 1, len(tokens)):
        if tokens[at].raw in ")]":
            return True
        if at not in inside and tokens[at].word not in _FILL:
            return False
    return True


def _negated(  # noqa: PLR0911, PLR0912 - a rule of grammar each
    tokens: Sequence[Token], inside: dict[int, _Mention], mention: _Mention
) -> bool | None:
    """Return True if a mention rules its option out; None: this is not clear."""
    after = [t.word for t in tokens[mention.end : mention.end + 3]]
    if after[:1] and after[0] in ("is", "was", "would") and any(w in _WRONG for w in after[1:]):
        return True
    elliptic = False
    between: list[str] = []
    for place in range(mention.start - 1, -1, -1):
        token = tokens[place]
        before = tokens[place - 1].word if place else ""
        if place in inside:
            between = []
            continue
        if token.raw in ".;:!?()[]\u2014\u2013" or (token.raw == "-"):
            return False
        if token.raw == ",":
            if any(w not in _FILL or w in _SPEECH for w in between):
                return False
            elliptic = True
        if token.word == "but":
            return before in ("anything", "all", "everything", "everywhere")
        if token.word == "than" and before in ("rather", "other"):
            return not elliptic
        if token.word == "of" and before == "instead":
            return not elliptic
        if token.word in _BREAKS or (token.word == "instead" and between[-1:] != ["of"]):
            return False
        if token.word == "no" and between[-1:] in (["longer"], ["way"]):
            return True
        if token.word in _NEGATORS:
            if between[-1:] == ["only"] or not _EXCLUDES.isdisjoint(between):
                return False
            return None if elliptic and token.word not in ("nor", "neither") else True
        if token.word == "and" and any(w in _SPEECH or w not in _FILL for w in between):
            return False
        if token.word:
            between.append(token.word)
    return False
