"""Chat models of providers, asked over the network through pydantic-ai."""

import math
import re
import warnings
from collections.abc import Callable, Coroutine, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, NoReturn

import msgspec

from beliefnest.errors import BeliefNestError, ModelError
from beliefnest.llm.budget import AnswerLimits
from beliefnest.llm.connecting import ByteCount, TooManyBytesError, bounded_client
from beliefnest.llm.failures import (
    TransientModelError,
    UnavailableModelError,
    UnusableAnswerError,
    excerpt,
)
from beliefnest.llm.messages import (
    Answer,
    AnswerForm,
    ChoiceSampling,
    Finish,
    Message,
    Sampling,
    Usage,
)
from beliefnest.llm.providers import Endpoint
from beliefnest.llm.routes import check_listening, check_route, proxy_variable
from beliefnest.world.texts import is_well_formed

if TYPE_CHECKING:  # Extras, imported when a provider is asked.
    import httpx2
    from pydantic_ai.messages import ModelMessage, ModelResponse
    from pydantic_ai.models import Model as ChatModel
    from pydantic_ai.models import ModelRequestParameters
    from pydantic_ai.profiles import ModelProfile
    from pydantic_ai.settings import ModelSettings

_CHARACTERS_PER_TOKEN = 4
"""Characters per token, to estimate usage if a server does not report it. A low estimate would
let a run exceed its limits."""

_THINKING_AS_TEXT: "ModelProfile" = {"thinking_tags": ("\0", "\0")}
"""Profile with marks of thinking that no model writes. The library takes `<think>` for a mark only
if it is a chunk of its own; `separate_thinking` reads all marks, however an answer was cut."""

_ANSWER = "answer"
"""Name of the structured form, and of its only field."""

_CUT = re.compile("length|max|limit|abort|error|fail|incomplete|interrupt|cancel|timeout|resource")
_FILTERED = re.compile("filter|guard|safety|refus|blocked|sensitive|moderat")
"""Words in names of reasons for the end of an answer."""

_MOST_TOKENS = 10**9
"""Greatest plausible token count. If a server reports more, usage is estimated instead."""


class RemoteModel(msgspec.Struct, frozen=True):
    """A model of a provider; it connects only when it is asked.

    Attributes:
        endpoint: Server and key.
        model: The provider's name of the model.
        limits: Limits on one answer.
    """

    endpoint: Endpoint
    model: str
    limits: AnswerLimits

    @property
    def name(self) -> str:
        """`PROVIDER:MODEL`."""
        return f"{self.endpoint.provider.name}:{self.model}"

    def check_server(self) -> None:
        """Refuse a server that nobody can connect to.

        Raises:
            UnavailableModelError: There is no such server, or variables of the environment are
                wrong.
        """
        place = self.endpoint
        check_listening(place.url, f"{self.name} at {place.place}", place.advice)

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the provider once.

        Raises:
            TransientModelError: The failure is temporary.
            UnavailableModelError: No request can succeed.
            ModelError: This request cannot succeed, or its answer exceeds a limit.
        """
        secrets = self.endpoint.secrets
        try:
            answer = self._answered(messages, sampling)
        except ModelError as error:
            error.args = (secrets.masked(str(error)),)
            raise
        return replace(answer, text=secrets.masked_answer(answer.text))

    def _answered(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask once; the result and the error may still contain secrets."""
        with _requiring_library():
            import pydantic_ai  # noqa: F401
        from pydantic_ai.exceptions import AgentRunError, UserError

        check_route(self.endpoint.url)
        try:
            with _quiet_about_counts():
                return _run(lambda: self._ask(messages, sampling))
        except (AgentRunError, UserError) as error:
            _refuse(self, error)
        except BeliefNestError:
            raise
        except Exception as error:  # noqa: BLE001  # whatever a server's nonsense lets a library raise
            raise self._unreadable(messages, error) from None

    def _unreadable(self, messages: Sequence[Message], error: Exception) -> UnusableAnswerError:
        cause: BaseException | None = error
        while cause is not None and not isinstance(cause, TooManyBytesError):
            cause = cause.__cause__ or cause.__context__
        what = str(cause) if cause else f"{type(error).__name__}: {error}"
        return UnusableAnswerError(
            f"{self.name} at {self.endpoint.place} gave an answer that cannot be read "
            f"({excerpt(_clean(self, what))}); ask again or use another model",
            _guessed_usage(self, messages, 0),
        )

    async def _ask(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        import asyncio

        from pydantic_ai.direct import model_request_stream

        limits, now = self.limits, asyncio.get_running_loop().time
        count = ByteCount(limits.silent_bytes)
        longest = max(limits.seconds, limits.first_token_seconds)
        settings = _settings(sampling)
        options = sampling.options if isinstance(sampling, ChoiceSampling) else ()
        received = 0
        try:
            # asyncio's timeout ends a stream that sends no event: the loop below would never run.
            async with (
                asyncio.timeout(limits.first_token_seconds) as alarm,
                bounded_client(self.endpoint, longest, count) as client,
                _chat_model(self.endpoint, self.model, client) as model,
                model_request_stream(
                    model,
                    _history(messages),
                    model_settings=settings,
                    model_request_parameters=(asked := self._parameters(model, options)),
                ) as stream,
            ):
                async for event in stream:
                    added = _length(event)
                    if added == 0:
                        continue
                    received += added
                    count.restart()
                    alarm.reschedule(now() + limits.seconds)
                    if received > limits.characters:
                        cut = _answer(self, messages, stream.get(), _form(asked))
                        return replace(cut, finish="length")
                response = stream.get()
                if not (count.ended or _has_ended(response)):
                    raise TransientModelError(
                        f"{self.name} at {self.endpoint.place} ended the stream in the middle of "
                        "its answer, before any reason for the end; ask again"
                    )
                return _answer(self, messages, response, _form(asked))
        except TimeoutError:
            usage = _guessed_usage(self, messages, received)
            raise UnusableAnswerError(_too_slow(self, received), usage) from None

    def _parameters(
        self, model: "ChatModel", options: Sequence[str]
    ) -> "ModelRequestParameters | None":
        """Return the form to ask for, the best that the model has; None: free text.

        Raises:
            ModelError: The model has no structured form.
        """
        if not options:
            return None
        from pydantic_ai.models import ModelRequestParameters
        from pydantic_ai.output import OutputObjectDefinition
        from pydantic_ai.tools import ToolDefinition

        schema = {
            "type": "object",
            "properties": {_ANSWER: {"type": "string", "enum": list(options)}},
            "required": [_ANSWER],
            "additionalProperties": False,
        }
        profile = model.profile
        if profile.get("supports_json_schema_output"):
            wanted = OutputObjectDefinition(json_schema=schema, name=_ANSWER, strict=True)
            return ModelRequestParameters(output_mode="native", output_object=wanted)
        if profile.get("supports_tools"):
            tool = ToolDefinition(name=_ANSWER, parameters_json_schema=schema, kind="output")
            return ModelRequestParameters(
                output_mode="tool", output_tools=[tool], allow_text_output=False
            )
        raise ModelError(
            f"{self.name} has no structured form of answers; leave out `answer: structured`"
        )


def _form(asked: "ModelRequestParameters | None") -> AnswerForm:
    if asked is None:
        return "text"
    return "schema" if asked.output_mode == "native" else "tool"


@contextmanager
def _requiring_library() -> Iterator[None]:
    try:
        yield
    except ImportError as error:
        # The library itself tells of packages of single providers without their names.
        missing = "" if error.name is None else f" ({error.name} is missing)"
        raise ModelError(
            f"models of providers need the extra 'llm'{missing}: "
            "pip install 'beliefnest[llm]', or run with --model offline"
        ) from None


@contextmanager
def _quiet_about_counts() -> Iterator[None]:
    """Silence the library's warnings about invalid token counts, which `_usage` replaces.

    If the user turns warnings into errors, they would abort a valid answer.
    """
    from pydantic_ai.exceptions import UsageExtractionFailedWarning

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Pydantic serializer warnings", UserWarning)
        warnings.simplefilter("ignore", UsageExtractionFailedWarning)
        yield


def _run(ask: Callable[[], Coroutine[Any, Any, Answer]]) -> Answer:
    """Run a coroutine to its end, even if an event loop is running already (notebooks)."""
    import asyncio
    import concurrent.futures

    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return asyncio.run(ask())
    with concurrent.futures.ThreadPoolExecutor(max_workers=1) as pool:
        return pool.submit(lambda: asyncio.run(ask())).result()


@_requiring_library()
def _chat_model(endpoint: Endpoint, model: str, client: "httpx2.AsyncClient") -> "ChatModel":
    key, url = endpoint.key.value, endpoint.address
    match endpoint.provider.protocol:
        case "anthropic":
            from pydantic_ai.models.anthropic import AnthropicModel
            from pydantic_ai.providers.anthropic import AnthropicProvider

            return AnthropicModel(
                model, provider=AnthropicProvider(api_key=key, base_url=url, http_client=client)
            )
        case "google":
            from pydantic_ai.models.google import GoogleModel
            from pydantic_ai.providers.google import GoogleProvider

            return GoogleModel(
                model, provider=GoogleProvider(api_key=key or "", base_url=url, http_client=client)
            )
        case "openai":
            from pydantic_ai.models.openai import OpenAIChatModel
            from pydantic_ai.providers.openai import OpenAIProvider

            # Use the chat completions API: the newer responses API does not accept a seed.
            openai = OpenAIProvider(api_key=key or "none", base_url=url, http_client=client)
            return OpenAIChatModel(model, provider=openai, profile=_THINKING_AS_TEXT)
        case "compatible":
            from pydantic_ai.models.openai import OpenAIChatModel
            from pydantic_ai.providers.openai_compatible import OpenAICompatibleProvider

            name = endpoint.provider.name
            compatible = OpenAICompatibleProvider(
                name, base_url=url, api_key=key, http_client=client
            )
            return OpenAIChatModel(model, provider=compatible, profile=_THINKING_AS_TEXT)


def _settings(sampling: Sampling) -> "ModelSettings":
    # The library must not retry: `RetryingModel` does it, with the project's clock.
    settings: ModelSettings = {"max_retries": 0}
    if sampling.temperature is not None:
        settings["temperature"] = sampling.temperature
    if sampling.seed is not None:
        settings["seed"] = sampling.seed
    if sampling.max_output_tokens is not None:
        settings["max_tokens"] = sampling.max_output_tokens
    return settings


def _history(messages: Sequence[Message]) -> "list[ModelMessage]":
    from pydantic_ai.messages import (
        ModelRequest,
        ModelResponse,
        SystemPromptPart,
        TextPart,
        UserPromptPart,
    )

    history: list[ModelMessage] = []
    asked: list[SystemPromptPart | UserPromptPart] = []
    for message in messages:
        match message.role:
            case "system":
                asked.append(SystemPromptPart(message.text))
            case "user":
                asked.append(UserPromptPart(message.text))
            case "assistant":
                history += [ModelRequest(parts=asked)] if asked else []
                history.append(ModelResponse(parts=[TextPart(message.text)]))
                asked = []
    return [*history, ModelRequest(parts=asked)] if asked else history


def _length(event: object) -> int:
    """Return the number of characters that an event of a stream adds to text or thinking."""
    from pydantic_ai.messages import (
        PartDeltaEvent,
        PartStartEvent,
        TextPart,
        TextPartDelta,
        ThinkingPart,
        ThinkingPartDelta,
        ToolCallPart,
        ToolCallPartDelta,
    )

    match event:
        case PartStartEvent(part=TextPart(content=text) | ThinkingPart(content=text)):
            return len(text)
        case PartDeltaEvent(delta=TextPartDelta(content_delta=text)):
            return len(text)
        case PartDeltaEvent(delta=ThinkingPartDelta(content_delta=str() as text)):
            return len(text)
        case PartStartEvent(part=ToolCallPart(args=str() as text)):
            return len(text)
        case PartDeltaEvent(delta=ToolCallPartDelta(args_delta=str() as text)):
            return len(text)
        case _:
            return 0


def _has_ended(response: "ModelResponse") -> bool:
    """Return True if the provider gave a reason for the end of an answer, of whatever name.

    Without a reason and without the mark of its end, a stream may be that of a connection that was
    cut, and its answer half of another.
    """
    reason = (response.provider_details or {}).get("finish_reason")
    # Of a stream without a reason the library says `stop`.
    return reason is not None or response.finish_reason not in (None, "stop")


def _answer(
    model: RemoteModel, messages: Sequence[Message], response: "ModelResponse", form: AnswerForm
) -> Answer:
    text = response.text or ""
    if form == "tool" and (calls := response.tool_calls):
        # Several calls are several statements, which the reader of answers judges.
        text = "\n".join([text, *(call.args_as_json_str() for call in calls)]).strip()
    usage = _usage(model, messages, response)
    finish = _finish(response)
    if finish == "content_filter":
        text = str((response.provider_details or {}).get("refusal") or text)
    if not is_well_formed(text):
        raise UnusableAnswerError(
            f"{model.name} gave an answer with half a surrogate pair in it; ask again", usage
        )
    return Answer(text, usage, date=datetime.now(UTC).date().isoformat(), finish=finish, form=form)


def _finish(response: "ModelResponse") -> Finish:
    """Return the reason for the end of an answer; servers have names of their own for it.

    Names that say nothing of a cut or a refusal end a whole answer.
    """
    named = (response.provider_details or {}).get("finish_reason")
    reason = f"{response.finish_reason} {named}".lower()
    if _FILTERED.search(reason):
        return "content_filter"
    return "length" if _CUT.search(reason) else "stop"


def _usage(model: RemoteModel, messages: Sequence[Message], response: "ModelResponse") -> Usage:
    counted = response.usage
    tokens = (counted.input_tokens, counted.output_tokens)
    # The library passes on the server's counts without validation.
    if not any(tokens) or not all(
        isinstance(each, int) and 0 <= each <= _MOST_TOKENS for each in tokens
    ):
        return _guessed_usage(model, messages, len(response.text or ""))
    cost = model.endpoint.cost(_cost(response))
    return Usage(1, counted.input_tokens, counted.output_tokens, cost)


def _guessed_usage(model: RemoteModel, messages: Sequence[Message], received: int) -> Usage:
    sent = sum(len(message.text) for message in messages)
    cost = model.endpoint.cost(None)
    return Usage(1, _guessed_tokens(sent), _guessed_tokens(received), cost)


def _guessed_tokens(characters: int) -> int:
    return math.ceil(characters / _CHARACTERS_PER_TOKEN)


def _cost(response: "ModelResponse") -> float | None:
    """Return the price in US dollars by the library's list; None for unknown models."""
    try:
        price = float(response.cost().total_price)
        return price if math.isfinite(price) and price >= 0 else None
    except (LookupError, ValueError, AssertionError):
        return None


def _too_slow(model: RemoteModel, received: int) -> str:
    if received:
        return (
            f"{model.name} sent nothing for {model.limits.seconds:g} s in the middle of its "
            "answer; wait longer (--answer-seconds, or answer_seconds of a study), or use a faster "
            "model"
        )
    return (
        f"{model.name} sent no token in {model.limits.first_token_seconds:g} s; wait longer "
        "(--first-token-seconds, or first_token_seconds of a study), or use a faster model"
    )


def _clean(model: RemoteModel, text: str) -> str:
    return model.endpoint.secrets.masked(text)


def _cause(error: BaseException | None, *kinds: type[BaseException]) -> BaseException | None:
    """Return the first cause of an error that is of one of some kinds."""
    while error is not None and not isinstance(error, kinds):
        error = error.__cause__ or error.__context__
    return error


def _unreachable(model: RemoteModel, error: Exception) -> UnavailableModelError | None:
    """Return the error for a failed connection; None: the connection did not fail."""
    import ssl

    import httpx2

    endpoint = model.endpoint
    failed = _cause(error, httpx2.ConnectError, httpx2.ConnectTimeout, httpx2.ProxyError)
    if failed is None:
        return None
    text = f"no server for {model.name} at {endpoint.place}"
    proxy = proxy_variable(endpoint.url)
    if (fault := _cause(error, ssl.SSLError)) is not None:
        return UnavailableModelError(
            f"{text} with a certificate to be trusted ({excerpt(_clean(model, str(fault)))}); "
            "name the file of its authority in SSL_CERT_FILE, or correct that variable"
        )
    if proxy is not None:
        return UnavailableModelError(
            f"{text} through the proxy of {proxy} ({excerpt(_clean(model, str(failed)))}); correct "
            f"{proxy}, or add the server to NO_PROXY"
        )
    return UnavailableModelError(f"{text}: {endpoint.advice}")


def _refuse(model: RemoteModel, error: Exception) -> NoReturn:
    """Raise the project's error for an error of the library.

    The cause is dropped, because it holds request headers.
    """
    from pydantic_ai import exceptions as library

    where = f"{model.name} at {model.endpoint.place}"
    if (proxy := proxy_variable(model.endpoint.url)) is not None:
        where += f", through the proxy of {proxy},"
    said = excerpt(_clean(model, str(error)))
    match error:
        case library.ModelAuthenticationError():
            refusal = f"{where} refused the key in {model.endpoint.key_variable}: check it"
            raise UnavailableModelError(refusal) from None
        case library.ModelNotFoundError():
            refusal = f"{where} was not found: check the model's name and the address ({said})"
            raise UnavailableModelError(refusal) from None
        case library.ModelQuotaExceededError():
            refusal = f"{where}: the account has no credit left ({said})"
            raise UnavailableModelError(refusal) from None
        case library.ModelContextWindowExceededError():
            message = f"{where}: the prompt is longer than the model can read; shorten it"
        case library.ModelRateLimitError(retry_after=seconds):
            raise TransientModelError(f"{where} limits the rate of requests", seconds) from None
        case library.ModelConnectionError() if unreachable := _unreachable(model, error):
            raise unreachable from None
        case library.ModelConnectionError():
            raise TransientModelError(f"{where} dropped the connection ({said})") from None
        case library.ModelServerError(retry_after=s) | library.ModelUnavailableError(retry_after=s):
            raise TransientModelError(f"{where} failed ({said})", s) from None
        case library.ModelAPIError():
            message = f"{where} rejected the request ({said})"
        case library.UnexpectedModelBehavior():
            message = f"{where} gave no usable answer ({said}); check that it speaks this protocol"
        case _:
            message = f"{where} gave no usable answer ({said})"
    raise ModelError(message) from None
